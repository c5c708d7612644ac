// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/rawlog_source.h"
#include "rawlog_fixture.h"

#include <gmock/gmock.h>

namespace engram::sources::test {
namespace {

using ::testing::HasSubstr;

struct Shipped {
  const char* file;
  std::size_t odometry;
  const char* content;
};

class MrptRawlogs : public testing::TestWithParam<Shipped> {};

// The rawlogs of Debian's mrpt-common: real odometry and laser, no images. The counts were taken with grep.
TEST_P(MrptRawlogs, ReadToTheEnd) {
  const std::string path = std::string("/usr/share/mrpt/datasets/") + GetParam().file;
  if (!std::filesystem::exists(path)) {
    if (std::getenv("CI")) FAIL() << path << " is missing: install mrpt-common";
    GTEST_SKIP() << path << " is missing: install mrpt-common";
  }
  auto source = openRawlog(path);
  EXPECT_FALSE(source->next());
  EXPECT_EQ(source->damage(), "");
  EXPECT_THAT(source->problem(), HasSubstr(GetParam().content));
  EXPECT_THAT(source->problem(), HasSubstr("but no images"));
  EXPECT_GE(source->stats().odometry + source->stats().odometryBad + source->stats().odometryBadStamp,
            GetParam().odometry);
  EXPECT_EQ(source->stats().odometryBad, 0u);
}

INSTANTIATE_TEST_SUITE_P(
    Shipped, MrptRawlogs,
    testing::Values(
        Shipped{"2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog", 224,
                "(CObservation2DRangeScan 225) and 224 actions (CActionRobotMovement2D 224) but no images"},
        Shipped{"localization_demo.rawlog", 37,
                "(CObservation2DRangeScan 37) and 37 actions (CActionRobotMovement2D 37) but no images"},
        Shipped{"RO-SLAM_demo.rawlog", 100,
                "(CObservationBeaconRanges 100) and 100 actions (CActionRobotMovement2D 100) but no images"},
        Shipped{"kf-slam_6D_demo.rawlog", 0,
                "(CObservationBearingRange 600) and 600 actions (CActionRobotMovement3D 600) but no images"},
        Shipped{"kf-slam_demo.rawlog", 250,
                "(CObservationBearingRange 250) and 250 actions (CActionRobotMovement2D 250) but no images"},
        Shipped{"test_rtk_path.rawlog", 0, "CObservationComment 1, CObservationGPS 691"},
        Shipped{"tests_rgbd.rawlog", 0, "CObservation3DRangeScan 1"},
        Shipped{"uwb_ro-localization_demo.rawlog", 343,
                "(CObservation2DRangeScan 343, CObservationBeaconRanges 339) and 343 actions "
                "(CActionRobotMovement2D 343) but no images"},
        Shipped{
            "graphslam-engine-demos/action_observations_map/range_030_bearing_015.rawlog", 1460,
            "(CObservation2DRangeScan 1460) and 1460 actions (CActionRobotMovement2D 1460) but no images"},
        Shipped{
            "graphslam-engine-demos/action_observations_map/simul.rawlog", 1733,
            "(CObservation2DRangeScan 1733) and 1733 actions (CActionRobotMovement2D 1733) but no images"}));

}  // namespace
}  // namespace engram::sources::test
