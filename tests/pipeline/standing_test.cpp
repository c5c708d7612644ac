// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/pipeline.h"
#include "tiny_drive.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <functional>

namespace engram::pipeline {
namespace {

using engram::testing::firstDrive;
using engram::testing::tinyParams;

/// What a robot without odometry that stands, or nearly, sees: image i.
using View = std::function<cv::Mat(int i)>;

/// Places of a map that so many images made.
std::size_t placesOf(const View& view, int images) {
  Pipeline mapper(tinyParams());
  for (int i = 0; i < images; ++i) {
    types::Frame frame;
    frame.index = static_cast<std::uint64_t>(i);
    frame.stamp = 0.1 * i;
    frame.image = view(i);
    mapper.process(frame);
  }
  mapper.finish();
  return mapper.map().places().size();
}

cv::Mat noisy(const cv::Mat& image, double sigma, int seed) {
  cv::RNG random(static_cast<std::uint64_t>(seed) + 1);
  cv::Mat noise(image.size(), CV_16SC(image.channels())), out;
  random.fill(noise, cv::RNG::NORMAL, 0, sigma);
  cv::add(image, noise, out, cv::noArray(), image.depth());
  return out;
}

const cv::Mat& spot(int i = 0) { return firstDrive().frames[static_cast<std::size_t>(i)].image; }

constexpr int kImages = 120;

/// wheels that turn before the same wall make nothing new.
TEST(Standing, WithABoundOfSimilarityTheImageIsAskedBesideTheWheels) {
  for (const double bound : {1.0, 0.9}) {
    PipelineParams params = tinyParams();
    params.select.max_similarity = bound;
    Pipeline mapper(params);
    int taken = 0;
    for (int i = 0; i < 6; ++i) {
      types::Frame frame;
      frame.index = static_cast<std::uint64_t>(i);
      frame.stamp = i;
      frame.image = i < 4 ? spot() : spot(12);
      frame.T_odom_robot = Eigen::Isometry3d(Eigen::Translation3d(0.6 * i, 0, 0));
      const auto report = mapper.process(frame);
      taken += report.outcome != types::Outcome::kSkipped;
      if (i == 2 && bound < 1) {
        EXPECT_EQ(report.reason, "the image is too similar to the last one");
      }
    }
    EXPECT_EQ(taken, bound < 1 ? 2 : 6);
  }
}

TEST(Standing, NoiseOfTheSensorMakesNoPlaces) {
  EXPECT_EQ(placesOf([](int i) { return noisy(spot(), 6, i); }, kImages), 1u);
}

/// A dark figure, a seventh of the view wide, walks round the robot twice.
TEST(Standing, SomeoneWhoPassesByMakesNoPlaces) {
  const auto view = [](int i) {
    cv::Mat image = noisy(spot(), 2, i);
    const double angle = 4 * CV_PI * i / kImages, radius = 0.33 * image.rows;
    const cv::Point at(cvRound(image.cols / 2.0 + radius * std::cos(angle)),
                       cvRound(image.rows / 2.0 + radius * std::sin(angle)));
    cv::circle(image, at, image.rows / 7, cv::Scalar::all(30), cv::FILLED);
    return image;
  };
  EXPECT_EQ(placesOf(view, kImages), 1u);
}

TEST(Standing, ARobotThatRocksMakesOnePlaceForEachEnd) {
  EXPECT_LE(placesOf([](int i) { return noisy(spot(i % 2), 2, i); }, kImages), 2u);
}

TEST(Standing, ARobotThatDrivesMakesThem) {
  EXPECT_GT(placesOf([](int i) { return spot(i); }, 12), 4u);
}

}  // namespace
}  // namespace engram::pipeline
