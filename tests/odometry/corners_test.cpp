// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "corners.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace engram::odometry {
namespace {

/// White squares on black, of rising contrast from left to right.
cv::Mat squares(const cv::Rect& where, int spacing) {
  cv::Mat image(240, 320, CV_8U, cv::Scalar(20));
  for (int y = where.y; y + 6 < where.br().y; y += spacing)
    for (int x = where.x; x + 6 < where.br().x; x += spacing) image(cv::Rect(x, y, 6, 6)) = 80 + x / 2;
  cv::GaussianBlur(image, image, {}, 0.8);  // no two neighbours alike, of which neither would be the best
  return image;
}

TEST(GridCorners, AreSpreadOverTheImage) {
  const auto corners = gridCorners(squares({0, 0, 320, 240}, 16), {}, 200, 10);
  EXPECT_LE(corners.size(), 200U);
  EXPECT_GE(corners.size(), 150U);
  int quarter[4] = {};
  for (const auto& c : corners) ++quarter[(c.x > 160 ? 1 : 0) + (c.y > 120 ? 2 : 0)];
  for (const int n : quarter) EXPECT_GE(n, 30);  // though those on the right have more contrast
}

TEST(GridCorners, TakesMoreWhereTheRestIsEmpty) {
  const auto corners = gridCorners(squares({160, 0, 160, 240}, 12), {}, 200, 10);
  EXPECT_GE(corners.size(), 180U);
  for (const auto& c : corners) EXPECT_GE(c.x, 155);
}

TEST(GridCorners, RespectsMaskAndBorder) {
  cv::Mat mask(240, 320, CV_8U, cv::Scalar(255));
  mask(cv::Rect(0, 0, 160, 240)) = 0;
  for (const auto& c : gridCorners(squares({0, 0, 320, 240}, 16), mask, 200, 10)) {
    EXPECT_GE(c.x, 160);
    EXPECT_TRUE(c.y >= 8 && c.y < 232 && c.x < 312) << c;
  }
  EXPECT_TRUE(gridCorners(cv::Mat(240, 320, CV_8U, cv::Scalar(100)), {}, 200, 10).empty());
}

}  // namespace
}  // namespace engram::odometry
