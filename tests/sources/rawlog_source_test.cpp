// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/rawlog_source.h"

#include "engram/base/error.h"
#include "engram/base/rng.h"
#include "engram/sources/odometry_track.h"
#include "rawlog_fixture.h"

#include <gmock/gmock.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationVelodyneScan.h>
#include <opencv2/imgcodecs.hpp>

#include <limits>

namespace engram::sources::test {
namespace {

using ::testing::HasSubstr;

/// Odometry at 10 Hz on a circle of radius 2 m, 0.2 rad/s; images at 4 Hz between.
Pose2 truthAt(double t) {
  const double a = 0.2 * t;
  return {2.0 * std::sin(a), 2.0 * (1.0 - std::cos(a)), a};
}

Objects circleDrive(int channels = 3) {
  Objects objects;
  int image = 0;
  for (int i = 0; i <= 50; ++i) {
    const double t = 0.1 * i;
    const Pose2 p = truthAt(t);
    objects.push_back(odometryObject(kStart + t, p.x, p.y, p.heading));
    objects.push_back(laserObject(kStart + t + 0.01));
    if (i % 3 == 1) objects.push_back(imageObject(kStart + t + 0.033, picture(image++, {64, 48}, channels)));
  }
  return objects;
}

void expectCircle(const std::vector<types::Frame>& frames, int channels = 3) {
  ASSERT_EQ(frames.size(), 17u);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double t = 0.1 * (1.0 + 3.0 * static_cast<double>(i)) + 0.033;
    EXPECT_EQ(frames[i].index, i);
    EXPECT_NEAR(frames[i].stamp, kStart + t, 1e-6);
    ASSERT_TRUE(frames[i].T_odom_robot) << i;
    EXPECT_TRUE(frames[i].T_odom_robot->isApprox(toIsometry(truthAt(t)), 1e-6)) << i;
    ASSERT_EQ(frames[i].image.channels(), channels);
    EXPECT_LT(difference(frames[i].image, picture(static_cast<int>(i), {64, 48}, channels)), 3.0);
  }
}

TEST(RawlogSource, ObservationsOnlyGzipAndPlain) {
  const TempFolder folder;
  for (const bool gzip : {true, false})
    for (const int channels : {1, 3}) {
      writeWithMrpt(folder.path("a.rawlog"), circleDrive(channels), gzip);
      auto source = openRawlog(folder.path("a.rawlog"));
      expectCircle(readFrames(*source), channels);
      EXPECT_EQ(source->problem(), "");
      EXPECT_EQ(source->stats().objects.at("CObservation2DRangeScan").at("LASER"), 51u);
      EXPECT_EQ(source->stats().odometry, 51u);
      EXPECT_NEAR(source->stats().pathLength, 2.0, 1e-3);  // 5 s at 0.4 m/s
    }
}

TEST(RawlogSource, SensoryFramesWithObservedOdometry) {
  const TempFolder folder;
  Objects frames;
  for (const auto& object : circleDrive()) frames.push_back(sensoryFrame({object}));
  writeWithMrpt(folder.path("a.rawlog"), frames, true);
  auto source = openRawlog(folder.path("a.rawlog"));
  expectCircle(readFrames(*source));
  EXPECT_EQ(source->problem(), "");
}

/// Pairs as MRPT defines them: an action, then the observations at its end.
Objects actionPairs(bool stamped, bool scanMatching) {
  Objects objects;
  for (int i = 0; i <= 10; ++i) {
    const Pose2 step = i == 0 ? Pose2{} : between(truthAt(0.5 * (i - 1)), truthAt(0.5 * i));
    const double stamp = kStart + 0.5 * i;
    if (i > 0)
      objects.push_back(actionObject(stamped ? stamp : -1.0, step.x, step.y, step.heading, scanMatching));
    objects.push_back(sensoryFrame({laserObject(stamp), imageObject(stamp, picture(i))}));
  }
  return objects;
}

TEST(RawlogSource, ActionsAreSummedUp) {
  const TempFolder folder;
  for (const bool stamped : {true, false})
    for (const bool scanMatching : {true, false}) {
      writeWithMrpt(folder.path("a.rawlog"), actionPairs(stamped, scanMatching), true);
      auto source = openRawlog(folder.path("a.rawlog"));
      const auto frames = readFrames(*source);
      ASSERT_EQ(frames.size(), 11u);
      EXPECT_EQ(source->problem(), "");
      for (std::size_t i = 0; i < frames.size(); ++i) {
        ASSERT_TRUE(frames[i].T_odom_robot);
        const Pose2 truth = truthAt(0.5 * static_cast<double>(i));
        EXPECT_TRUE(frames[i].T_odom_robot->isApprox(toIsometry(truth), 1e-6))
            << i << stamped << scanMatching;
      }
    }
}

TEST(RawlogSource, ImageBetweenTwoActionsIsInterpolated) {
  const TempFolder folder;
  writeWithMrpt(folder.path("a.rawlog"),
                {sensoryFrame({imageObject(kStart, picture(0))}), actionObject(kStart + 1.0, 1, 0, 0),
                 sensoryFrame({imageObject(kStart + 1.5, picture(1))}), actionObject(kStart + 2.0, 1, 0, 0),
                 sensoryFrame({imageObject(kStart + 2.0, picture(2))})},
                false);
  auto source = openRawlog(folder.path("a.rawlog"));
  const auto frames = readFrames(*source);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_NEAR(frames[0].T_odom_robot->translation().x(), 0.0, 1e-9);
  EXPECT_NEAR(frames[1].T_odom_robot->translation().x(), 1.5, 1e-6);
  EXPECT_NEAR(frames[2].T_odom_robot->translation().x(), 2.0, 1e-6);
}

TEST(RawlogSource, MixedLayouts) {
  const TempFolder folder;
  Objects objects = actionPairs(true, false);
  objects.push_back(odometryObject(kStart + 5.05, 100, 100, 0));  // the other kind: ignored after actions
  objects.push_back(imageObject(kStart + 5.1, picture(11)));
  objects.push_back(laserObject(kStart + 5.2));
  writeWithMrpt(folder.path("a.rawlog"), objects, true);
  auto source = openRawlog(folder.path("a.rawlog"));
  const auto frames = readFrames(*source);
  ASSERT_EQ(frames.size(), 12u);
  EXPECT_TRUE(frames[11].T_odom_robot->isApprox(toIsometry(truthAt(5.0)), 1e-6));
  EXPECT_EQ(source->stats().odometryOther, 1u);

  RawlogParams params;
  params.odometry = "observation";
  auto other = openRawlog(folder.path("a.rawlog"), params);
  EXPECT_NEAR(readFrames(*other)[11].T_odom_robot->translation().x(), 100.0, 1e-9);
  params.odometry = "none";
  auto none = openRawlog(folder.path("a.rawlog"), params);
  for (const auto& frame : readFrames(*none)) EXPECT_FALSE(frame.T_odom_robot);
  EXPECT_EQ(none->problem(), "");
}

TEST(RawlogSource, StereoPairs) {
  const TempFolder folder;
  Objects objects;
  for (int i = 0; i < 3; ++i) objects.push_back(stereoObject(kStart + i, picture(i), picture(10 + i)));
  writeWithMrpt(folder.path("a.rawlog"), objects, true);
  auto source = openRawlog(folder.path("a.rawlog"));
  const auto frames = readFrames(*source);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_LT(difference(frames[2].right, picture(12)), 3.0);
  EXPECT_EQ(frames[1].label, "STEREO");
  EXPECT_FALSE(frames[0].T_odom_robot);
  EXPECT_EQ(source->problem(), "");
}

TEST(RawlogSource, ExternalImagesAndMissingOnes) {
  const TempFolder folder;
  std::filesystem::create_directory(folder.path("a_Images"));
  cv::imwrite(folder.path("a_Images/x.png"), picture(7));
  writeWithMrpt(folder.path("a.rawlog"),
                {externalImageObject(kStart, "x.png"), externalImageObject(kStart + 1, "gone.png"),
                 externalImageObject(kStart + 2, "x.png")},
                true);
  auto source = openRawlog(folder.path("a.rawlog"));
  const auto frames = readFrames(*source);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(difference(frames[0].image, picture(7)), 0.0);
  EXPECT_EQ(frames[0].label, "x.png");
  EXPECT_THAT(source->problem(), HasSubstr("1 image left out: file not found"));
  EXPECT_THAT(source->problem(), HasSubstr("gone.png"));

  std::filesystem::rename(folder.path("a_Images"), folder.path("elsewhere"));
  RawlogParams params;
  params.images_dir = folder.path("elsewhere");
  auto moved = openRawlog(folder.path("a.rawlog"), params);
  EXPECT_EQ(readFrames(*moved).size(), 2u);
}

TEST(RawlogSource, ExternalImagesInMrptsOtherPlaces) {
  for (const char* place : {"a_images", "Images"}) {
    const TempFolder folder;
    std::filesystem::create_directory(folder.path(place));
    cv::imwrite(folder.path(std::string(place) + "/x.png"), picture(7));
    writeWithMrpt(folder.path("a.rawlog"), {externalImageObject(kStart, "x.png")}, true);
    const auto source = openRawlog(folder.path("a.rawlog"));
    const auto frames = readFrames(*source);
    ASSERT_EQ(frames.size(), 1u) << place;
    EXPECT_EQ(difference(frames[0].image, picture(7)), 0.0);
  }
}

TEST(RawlogSource, KnowsTheLabelsOfOtherSensors) {
  const TempFolder folder;
  const auto named = [](auto observation, const char* label) {
    observation->sensorLabel = label;
    observation->timestamp = mrpt::Clock::fromDouble(kStart);
    return observation;
  };
  const auto scan = named(std::make_shared<mrpt::obs::CObservation2DRangeScan>(), "L1");
  scan->resizeScan(181);
  const auto lidar = named(std::make_shared<mrpt::obs::CObservationVelodyneScan>(), "VLP");
  lidar->scan_packets.resize(2);
  const auto imu = named(std::make_shared<mrpt::obs::CObservationIMU>(), "IMU1");
  writeWithMrpt(folder.path("a.rawlog"), {scan, lidar, imu, imageObject(kStart, picture(1))}, true);
  const auto source = openRawlog(folder.path("a.rawlog"));
  readFrames(*source);
  const auto labelOf = [&](const char* name) { return source->stats().objects.at(name).begin()->first; };
  EXPECT_EQ(labelOf("CObservation2DRangeScan"), "L1");
  EXPECT_EQ(labelOf("CObservationVelodyneScan"), "VLP");
  EXPECT_EQ(labelOf("CObservationIMU"), "IMU1");
}

TEST(RawlogSource, ChoosesACamera) {
  const TempFolder folder;
  Objects objects;
  for (int i = 0; i < 4; ++i) {
    objects.push_back(imageObject(kStart + i, picture(i), "FRONT"));
    objects.push_back(imageObject(kStart + i, picture(10 + i), "BACK"));
  }
  writeWithMrpt(folder.path("a.rawlog"), objects, true);
  auto first = openRawlog(folder.path("a.rawlog"));
  EXPECT_EQ(readFrames(*first).size(), 4u);
  EXPECT_THAT(first->problem(), HasSubstr("several cameras, of which FRONT was used"));
  EXPECT_THAT(first->problem(), HasSubstr("BACK (4 images), FRONT (4 images)"));
  RawlogParams params;
  params.sensor_label = "BACK";
  auto back = openRawlog(folder.path("a.rawlog"), params);
  EXPECT_LT(difference(readFrames(*back)[1].image, picture(11)), 3.0);
  EXPECT_EQ(back->problem(), "");
  params.sensor_label = "TOP";
  auto none = openRawlog(folder.path("a.rawlog"), params);
  EXPECT_TRUE(readFrames(*none).empty());
  EXPECT_THAT(none->problem(), HasSubstr("no camera has the label 'TOP'"));
}

TEST(RawlogSource, BadOdometryAndStampsAreLeftOut) {
  const TempFolder folder;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  writeWithMrpt(folder.path("a.rawlog"),
                {odometryObject(kStart, 0, 0, 0), imageObject(kStart + 0.5, picture(0)),
                 odometryObject(kStart + 0.6, nan, 0, 0), odometryObject(kStart + 1, 1, 0, 0),
                 odometryObject(kStart + 0.8, 50, 0, 0), imageObject(kStart + 0.5, picture(1)),
                 imageObject(kStart + 0.4, picture(2)), imageObject(kStart + 0.9, picture(3, {32, 32})),
                 odometryObject(kStart + 1, 7, 0, 0)},
                true);
  auto source = openRawlog(folder.path("a.rawlog"));
  const auto frames = readFrames(*source);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_NEAR(frames[0].T_odom_robot->translation().x(), 0.5, 1e-6);
  EXPECT_NEAR(frames[1].T_odom_robot->translation().x(), 0.9, 1e-6);
  EXPECT_EQ(frames[1].image.size(),
            cv::Size(32, 32));  // another size in mid-sequence is the consumer's business
  EXPECT_EQ(source->stats().imagesBadStamp, 2u);
  EXPECT_EQ(source->stats().odometryBad, 1u);
  EXPECT_EQ(source->stats().odometryBadStamp, 2u);
  EXPECT_THAT(source->problem(), HasSubstr("2 images left out: the stamp repeats or goes back"));
  EXPECT_THAT(source->problem(), HasSubstr("1 odometry reading left out: not a number"));
}

TEST(RawlogSource, AClockThatWasSetLosesNoImage) {
  const TempFolder folder;
  Objects objects;
  for (const double start : {kStart - 1e9, kStart, kStart - 1000})
    for (int i = 0; i < 15; ++i) {
      objects.push_back(odometryObject(start + 0.1 * i, 0.1 * i, 0, 0));
      objects.push_back(imageObject(start + 0.1 * i, picture(i, {16, 16})));
    }
  writeWithMrpt(folder.path("a.rawlog"), objects, true);
  auto source = openRawlog(folder.path("a.rawlog"));
  const auto frames = readFrames(*source);
  ASSERT_EQ(frames.size(), 45u);
  EXPECT_NEAR(frames[15].stamp, kStart, 1e-6);
  EXPECT_NEAR(frames[20].T_odom_robot->translation().x(), 0.5, 1e-6);
  EXPECT_NEAR(frames[35].T_odom_robot->translation().x(), 0.5, 1e-6);
  EXPECT_EQ(source->stats().imagesBadStamp + source->stats().odometryBadStamp, 0u);
  EXPECT_THAT(source->problem(),
              HasSubstr("1 time the clock leapt ahead by more than a year: time starts anew"));
  EXPECT_THAT(source->problem(), HasSubstr("1 time the clock was set back: time starts anew"));
}

TEST(RawlogSource, AWildStampIsNamedAsWhatItIs) {
  const TempFolder folder;
  Objects objects;
  for (int i = 0; i < 5; ++i)
    objects.push_back(imageObject(kStart + i + (i == 2 ? 1e9 : 0), picture(i, {16, 16})));
  writeWithMrpt(folder.path("a.rawlog"), objects, true);
  auto source = openRawlog(folder.path("a.rawlog"));
  EXPECT_EQ(readFrames(*source).size(), 4u);
  EXPECT_THAT(source->problem(), HasSubstr("1 image left out: the stamp leaps ahead by more than a year"));
  EXPECT_THAT(source->problem(), ::testing::Not(HasSubstr("goes back")));
}

/// Every count of 100 ns since 1601 is a time: none overflows.
TEST(RawlogSource, StampsAtTheEndsOfTheirRange) {
  const TempFolder folder;
  const std::uint64_t kLast = std::numeric_limits<std::uint64_t>::max();
  for (const std::uint64_t ticks : {std::uint64_t{1}, kLast / 2 + 1, kLast - 1, kLast}) {
    auto image = imageObject(kStart, picture(0));
    std::dynamic_pointer_cast<mrpt::obs::CObservation>(image)->timestamp =
        mrpt::Clock::time_point(mrpt::Clock::duration(static_cast<std::int64_t>(ticks)));
    writeWithMrpt(folder.path("a.rawlog"), {image}, true);
    auto source = openRawlog(folder.path("a.rawlog"));
    const auto frames = readFrames(*source);
    ASSERT_EQ(frames.size(), 1u);
    EXPECT_NEAR(frames[0].stamp / (static_cast<double>(ticks) * 1e-7 - 11644473600.0), 1, 1e-9) << ticks;
  }
}

TEST(RawlogSource, LookAheadIsBounded) {
  const TempFolder folder;
  Objects objects{odometryObject(kStart, 0, 0, 0)};
  for (int i = 1; i <= 40; ++i) objects.push_back(imageObject(kStart + 0.01 * i, picture(i, {16, 16})));
  objects.push_back(odometryObject(kStart + 0.4, 4, 0, 0));
  writeWithMrpt(folder.path("a.rawlog"), objects, true);
  RawlogParams params;
  params.look_ahead = 10;
  auto bounded = openRawlog(folder.path("a.rawlog"), params);
  const auto held = readFrames(*bounded);
  EXPECT_NEAR(held[4].T_odom_robot->translation().x(), 0.0, 1e-9);  // given up waiting: the last sample holds
  EXPECT_NEAR(held[35].T_odom_robot->translation().x(), 3.6, 1e-4);
  params.look_ahead = 100;
  auto patient = openRawlog(folder.path("a.rawlog"), params);
  EXPECT_NEAR(readFrames(*patient)[4].T_odom_robot->translation().x(), 0.5, 1e-4);
}

TEST(RawlogSource, ProgressRisesToOne) {
  const TempFolder folder;
  Objects objects;
  for (int i = 0; i < 60; ++i) objects.push_back(imageObject(kStart + i, picture(i, {160, 120})));
  writeWithMrpt(folder.path("a.rawlog"), objects, true);
  auto source = openRawlog(folder.path("a.rawlog"));
  double last = source->progress();
  EXPECT_GE(last, 0.0);
  bool between = false;
  while (source->next()) {
    EXPECT_GE(source->progress(), last);
    last = source->progress();
    between = between || (last > 0.1 && last < 0.9);
  }
  EXPECT_TRUE(between);
  EXPECT_EQ(source->progress(), 1.0);
}

TEST(RawlogSource, WithoutImagesItSaysSo) {
  const TempFolder folder;
  writeWithMrpt(folder.path("a.rawlog"), {laserObject(kStart), odometryObject(kStart, 0, 0, 0)}, true);
  auto source = openRawlog(folder.path("a.rawlog"));
  EXPECT_FALSE(source->next());
  EXPECT_THAT(
      source->problem(),
      HasSubstr("it holds 2 observations (CObservation2DRangeScan 1, CObservationOdometry 1) but no images"));
}

TEST(RawlogSource, ParametersAreChecked) {
  RawlogParams params;
  params.odometry = "wheels";
  EXPECT_THROW(openRawlog("x.rawlog", params), base::ConfigError);
}

}  // namespace
}  // namespace engram::sources::test
