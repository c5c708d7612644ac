// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/appearance/describer.h"

#include "engram/base/error.h"
#include "engram/base/rng.h"
#include "engram/cameras/equirectangular.h"
#include "engram/cameras/pinhole.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <cmath>

namespace engram::appearance {
namespace {

AppearanceParams channel(const std::string& name) {
  AppearanceParams params;
  params.channel = name;
  return params;
}

/// Blobs of random light, as smooth as a small picture of a room.
cv::Mat scene(std::uint64_t seed, cv::Size size = {256, 128}, int blob = 8) {
  base::Rng rng(seed);
  cv::Mat coarse(size.height / blob, size.width / blob, CV_8U);
  for (int y = 0; y < coarse.rows; ++y)
    for (int x = 0; x < coarse.cols; ++x)
      coarse.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(rng.below(256));
  cv::Mat picture;
  cv::resize(coarse, picture, size, 0, 0, cv::INTER_CUBIC);
  return picture;
}

double correlation(const Describer& describer, const cv::Mat& query, const cv::Mat& place) {
  return static_cast<double>(
      (describer.describe(place).transpose() * describer.describeQuery(query)).maxCoeff());
}

std::optional<Panorama> allRound(cv::Size size) {
  return Panorama::of(cameras::makeRig(std::make_shared<cameras::Equirectangular>(size)));
}

class Channels : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, Channels, ::testing::Values("thumbnail", "hog"));

TEST_P(Channels, ASignatureHasMeanNoughtAndLengthOne) {
  const auto describer = makeDescriber(channel(GetParam()));
  const Eigen::VectorXf v = describer->describe(scene(1));
  EXPECT_EQ(v.size(), describer->dim());
  EXPECT_NEAR(v.mean(), 0, 1e-5);
  EXPECT_NEAR(v.norm(), 1, 1e-5);
  EXPECT_EQ(describer->describe(scene(1)), v);
}

TEST_P(Channels, LightAndShadeOfWholePartsCountForLittle) {
  const auto describer = makeDescriber(channel(GetParam()));
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    const cv::Mat day = scene(seed);
    cv::Mat night = 0.25 * day + 10;
    night.colRange(128, 256) = day.colRange(128, 256) * 0.5;
    const double same = correlation(*describer, night, day);
    EXPECT_GT(same, 0.8);
    EXPECT_LT(correlation(*describer, night, scene(seed + 100)), 0.5 * same);
  }
}

TEST_P(Channels, APlainPictureIsLikeNothing) {
  const auto describer = makeDescriber(channel(GetParam()));
  const cv::Mat plain(64, 128, CV_8UC3, cv::Scalar(90, 90, 90));
  EXPECT_NEAR(correlation(*describer, plain, scene(3)), 0, 1e-6);
}

TEST_P(Channels, ACameraThatSeesAllRoundFindsTheHeading) {
  const cv::Size size{256, 128};
  const auto describer = makeDescriber(channel(GetParam()), allRound(size));
  const cv::Mat place = scene(4, size, 32), other = scene(5, size, 32);
  for (const int turn : {8, 32, 100, 255}) {
    cv::Mat turned;
    cv::hconcat(place.colRange(turn, size.width), place.colRange(0, turn), turned);
    EXPECT_GT(correlation(*describer, turned, place), correlation(*describer, turned, other) + 0.2) << turn;
  }
}

TEST(Hog, AnUprightEdgeIsInTheBinsOfItsGradient) {
  const auto describer = makeDescriber(channel("hog"));
  cv::Mat edge(64, 128, CV_8U, cv::Scalar(0));
  edge.colRange(20, 128) = 200;  // in the third column of cells; eight rows of cells a column
  const Eigen::VectorXf v = describer->describe(edge);
  const float background = v.minCoeff();
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    const Eigen::Index bin = i % 9, column = i / 9 / 8;
    const bool expected = column == 2 && (bin == 0 || bin == 8);  // half of 0 rad goes to either side
    EXPECT_EQ(v[i] > background + 1e-6, expected) << "cell " << i / 9 << ", bin " << bin;
  }
}

TEST(Thumbnail, IsEachPatchLessItsMeanOverItsDeviation) {
  const auto describer = makeDescriber(channel("thumbnail"));
  const cv::Mat picture = scene(7, {64, 32});  // one pixel of the signature for each of the picture
  const Eigen::VectorXf v = describer->describe(picture);
  std::vector<double> expected;
  for (int column = 0; column < 8; ++column)
    for (int row = 0; row < 4; ++row) {
      double sum = 0, squares = 0;
      const auto at = [&](int i, int j) {
        return static_cast<double>(picture.at<std::uint8_t>(8 * row + j, 8 * column + i));
      };
      for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) sum += at(i, j), squares += at(i, j) * at(i, j);
      const double mean = sum / 64, deviation = std::sqrt(squares / 64 - mean * mean);
      for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) expected.push_back((at(i, j) - mean) / (deviation + 3));
    }
  double norm = 0;
  for (const double e : expected) norm += e * e;  // the mean of all patches is 0 already
  for (std::size_t i = 0; i < expected.size(); ++i)
    ASSERT_NEAR(v[static_cast<Eigen::Index>(i)], expected[i] / std::sqrt(norm), 1e-4) << i;
}

TEST(Describer, OnlyCamerasThatSeeAllRoundAreUnwrapped) {
  EXPECT_FALSE(Panorama::of(cameras::makeRig(cameras::approximatePinhole({640, 480}, 1.0))));
  EXPECT_TRUE(allRound({256, 128}));
  EXPECT_EQ(makeDescriber(channel("none")), nullptr);
  EXPECT_THROW(makeDescriber(channel("hog"))->describe({}), base::Error);
}

/// Column by column the strip of an equirectangular picture is the picture around the horizon.
TEST(Panorama, GoesRoundToTheLeftFromAhead) {
  const cv::Size size{360, 180};
  cv::Mat picture(size, CV_8U);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) picture.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(x / 2);
  const cv::Mat strip = allRound(size)->strip(picture, {36, 6});
  for (int column = 0; column < 36; ++column) {
    const double heading = (column + 0.5) * 10;                  // [deg], to the left
    const double x = std::fmod(180.0 - heading + 360.0, 360.0);  // ahead is in the middle of the picture
    if (x < 2 || x > 358) continue;                              // at the seam
    EXPECT_NEAR(strip.at<std::uint8_t>(3, column), x / 2, 1.01) << column;
  }
}

}  // namespace
}  // namespace engram::appearance
