// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "plan_picture.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace engram::apps {

cv::Mat drawPlan(const world::World& world, const world::Appearance& appearance) {
  const world::Plan& plan = world.plan();
  const double scale = std::clamp(1600 / std::max(plan.width(), plan.depth()), 4.0, 48.0);  // [px/m]
  cv::Mat image(static_cast<int>(plan.depth() * scale) + 1, static_cast<int>(plan.width() * scale) + 1,
                CV_8UC3, cv::Scalar(255, 255, 255));
  const auto at = [&](double x, double y) {
    return cv::Point(static_cast<int>(std::lround(x * scale)),
                     image.rows - 1 - static_cast<int>(std::lround(y * scale)));
  };
  for (int y = 0; y < plan.rows; ++y)
    for (int x = 0; x < plan.columns; ++x) {
      const char c = plan.at(x, y);
      if (c == ' ') continue;
      const cv::Scalar colour = c == '#'   ? cv::Scalar(70, 70, 70)
                                : c == '+' ? cv::Scalar(150, 190, 230)
                                : c == '=' ? cv::Scalar(235, 200, 130)
                                : c == '.' ? cv::Scalar(240, 240, 240)
                                           : cv::Scalar(225, 238, 225);
      cv::rectangle(image, at(x * plan.cell, y * plan.cell), at((x + 1) * plan.cell, (y + 1) * plan.cell),
                    colour, cv::FILLED);
    }
  for (const auto& f : appearance.furniture) {
    const Eigen::Vector2f low = f.centre - f.half(), high = f.centre + f.half();
    const bool rug = f.kind == world::FurnitureKind::kRug;
    cv::rectangle(image, at(low.x(), low.y()), at(high.x(), high.y()),
                  rug ? cv::Scalar(200, 200, 230) : cv::Scalar(120, 150, 190), rug ? 1 : cv::FILLED);
  }
  const world::Route& route = world.route();
  for (double s = 0; s < route.length(); s += 0.05) {
    const auto a = route.at(s), b = route.at(s + 0.05);
    cv::line(image, at(a.x, a.y), at(b.x, b.y), {40, 40, 200}, 1, cv::LINE_AA);
  }
  for (int k = 0; k < route.stations(); ++k) {
    const auto p = route.at(k * route.pitch());
    cv::circle(image, at(p.x, p.y), 3, {40, 40, 200}, cv::FILLED, cv::LINE_AA);
    if (k % 5 == 0)
      cv::putText(image, std::to_string(k), at(p.x + 0.12, p.y + 0.12), cv::FONT_HERSHEY_SIMPLEX, 0.45,
                  {160, 30, 30}, 1, cv::LINE_AA);
  }
  return image;
}

}  // namespace engram::apps
