// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/odometry/row_matcher.h"

#include "engram/base/rng.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cmath>

namespace engram::odometry {
namespace {

/// A sum of waves in all directions: it can be drawn at any shift exactly.
cv::Mat texture(std::uint64_t seed, double shift = 0, double gain = 1, double noise = 0) {
  struct Wave {
    double a, b, phase;
  };
  base::Rng rng(seed), speckle(seed + 1000);
  std::vector<Wave> waves(30);
  for (auto& w : waves) w = {rng.uniform(-0.9, 0.9), rng.uniform(-0.9, 0.9), rng.uniform(0, 2 * M_PI)};
  cv::Mat image(160, 320, CV_8U);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      double sum = 0;
      for (const auto& w : waves) sum += std::sin(w.a * (x + shift) + w.b * y + w.phase);
      image.at<std::uint8_t>(y, x) =
          cv::saturate_cast<std::uint8_t>(gain * (100 + 12 * sum) + speckle.normal(0, noise));
    }
  return image;
}

/// The right image of a plane at a disparity: what is at u in the left one is at u - d.
types::StereoPair planeAt(double d, double gain = 1, double noise = 0) {
  return {texture(5, 0, 1, noise), texture(5, d, gain, noise)};
}

struct Errors {
  int found = 0, tried = 0;
  double mean = 0, rms = 0;
};

Errors errorsAt(double d, double gain = 1, double noise = 0, float fraction = 0) {
  const RowMatcher rows(planeAt(d, gain, noise), 64);
  Errors e;
  for (int v = 12; v < 148; v += 12)
    for (int u = 90; u < 300; u += 10) {
      ++e.tried;
      const auto found = rows.disparity(static_cast<float>(u) + fraction, static_cast<float>(v));
      if (!found) continue;
      ++e.found;
      e.mean += *found - d;
      e.rms += (*found - d) * (*found - d);
    }
  e.mean /= std::max(1, e.found);
  e.rms = std::sqrt(e.rms / std::max(1, e.found));
  return e;
}

TEST(RowMatcher, DisparityToATenthOfAPixel) {
  for (const double d : {1.0, 3.3, 7.5, 12.8, 40.25, 60.0}) {
    const Errors e = errorsAt(d);
    EXPECT_GE(e.found, 0.9 * e.tried) << d;
    EXPECT_LT(e.rms, 0.08) << d;
    EXPECT_LT(std::abs(e.mean), 0.03) << d;
  }
}

TEST(RowMatcher, PointsBetweenPixels) {
  const Errors e = errorsAt(12.3, 1, 0, 0.4f);
  EXPECT_LT(e.rms, 0.08);
  EXPECT_LT(std::abs(e.mean), 0.03);
}

TEST(RowMatcher, NoiseAndAnotherExposure) {
  const Errors e = errorsAt(17.6, 0.8, 4);
  EXPECT_GE(e.found, 0.8 * e.tried);
  EXPECT_LT(e.rms, 0.2);
}

TEST(RowMatcher, NearAnExpectedDisparityOnly) {
  const RowMatcher rows(planeAt(20), 64);
  EXPECT_TRUE(rows.disparity(160, 80, 22, 4));
  EXPECT_FALSE(rows.disparity(160, 80, 45, 4));
}

TEST(RowMatcher, RefusesWhatCannotBeKnown) {
  const cv::Mat flat(160, 320, CV_8U, cv::Scalar(90));
  EXPECT_FALSE(RowMatcher({flat, flat}, 64).disparity(160, 80));
  // Stripes: every period fits.
  cv::Mat stripes(160, 320, CV_8U);
  for (int x = 0; x < 320; ++x) stripes.col(x) = 100 + 60 * std::sin(x * 2 * M_PI / 8);
  EXPECT_FALSE(RowMatcher({stripes, stripes}, 64).disparity(160, 80));
  // Another picture in the right eye.
  const RowMatcher unrelated({texture(5), texture(77)}, 64);
  int found = 0;
  for (int u = 90; u < 300; u += 5) found += unrelated.disparity(static_cast<float>(u), 80).has_value();
  EXPECT_LE(found, 6);
  const RowMatcher rows(planeAt(20), 64);
  EXPECT_FALSE(rows.disparity(3, 80));
  EXPECT_FALSE(rows.disparity(318, 80));
  EXPECT_FALSE(rows.disparity(160, 2));
  EXPECT_FALSE(rows.disparity(15, 80));  // its partner would be outside
  EXPECT_FALSE(RowMatcher(planeAt(0), 64).disparity(160, 80)) << "at infinity";
}

}  // namespace
}  // namespace engram::odometry
