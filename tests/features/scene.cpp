// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene.h"

#include "engram/base/rng.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace engram::features::test {

cv::Mat texturedScene(int width, int height, std::uint64_t seed) {
  base::Rng rng(seed);
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(128));
  const auto at = [&] {
    return cv::Point(static_cast<int>(rng.below(static_cast<std::uint32_t>(width))),
                     static_cast<int>(rng.below(static_cast<std::uint32_t>(height))));
  };
  for (int i = 0; i < 700; ++i) {
    const auto grey = cv::Scalar(rng.uniform(0, 255));
    const double extent = 3 * std::exp(rng.uniform(0, 2.7));
    const cv::Size2f size(static_cast<float>(extent), static_cast<float>(extent * rng.uniform(0.5, 2)));
    const cv::RotatedRect box(at(), size, static_cast<float>(rng.uniform(0, 180)));
    if (i % 2) {
      cv::ellipse(image, box, grey, cv::FILLED, cv::LINE_AA);
      continue;
    }
    cv::Point2f corners[4];
    box.points(corners);
    const std::vector<cv::Point> polygon(corners, corners + 4);
    cv::fillConvexPoly(image, polygon, grey, cv::LINE_AA);
  }
  cv::GaussianBlur(image, image, {}, 0.7);
  return image;
}

cv::Matx33d similarity(cv::Size size, double angle, double scale) {
  const double cx = (size.width - 1) / 2.0, cy = (size.height - 1) / 2.0;
  const double c = scale * std::cos(angle), s = scale * std::sin(angle);
  return {c, -s, cx - c * cx + s * cy, s, c, cy - s * cx - c * cy, 0, 0, 1};
}

cv::Mat warped(const cv::Mat& image, const cv::Matx33d& H, const Photometry& photometry, std::uint64_t seed) {
  cv::Mat out;
  cv::warpPerspective(image, out, H, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  base::Rng rng(seed);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      auto& v = out.at<std::uint8_t>(y, x);
      const double noise = photometry.noise > 0 ? rng.normal(0, photometry.noise) : 0;
      v = cv::saturate_cast<std::uint8_t>(photometry.gain * v + photometry.offset + noise);
    }
  return out;
}

std::vector<cv::Point2f> points(const types::Features& features) {
  std::vector<cv::Point2f> out;
  for (const auto& k : features.keypoints) out.emplace_back(k.x, k.y);
  return out;
}

Agreement compare(const std::vector<cv::Point2f>& a, const std::vector<cv::Point2f>& b,
                  const std::vector<types::Match>& matches, const cv::Matx33d& H, cv::Size size,
                  double tolerance) {
  constexpr double kBorder = 20;
  const auto mapped = [&](cv::Point2f p) {
    const cv::Vec3d q = H * cv::Vec3d(p.x, p.y, 1);
    return cv::Point2d(q[0] / q[2], q[1] / q[2]);
  };
  const auto near = [&](cv::Point2f p, cv::Point2f q) {
    return cv::norm(mapped(p) - cv::Point2d(q)) <= tolerance;
  };
  Agreement out;
  for (const auto& p : a) {
    const auto m = mapped(p);
    if (m.x < kBorder || m.y < kBorder || m.x > size.width - kBorder || m.y > size.height - kBorder) continue;
    ++out.visible;
    out.repeated += std::any_of(b.begin(), b.end(), [&](cv::Point2f q) { return near(p, q); });
  }
  out.matches = static_cast<int>(matches.size());
  for (const auto& m : matches)
    out.correct += near(a[static_cast<std::size_t>(m.a)], b[static_cast<std::size_t>(m.b)]);
  return out;
}

}  // namespace engram::features::test
