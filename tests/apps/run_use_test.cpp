// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/run_use.h"

#include "engram/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace engram::apps {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using types::Outcome;

void add(RunUse& use, int times, Outcome outcome, const std::string& reason = {}) {
  types::FrameReport report;
  report.outcome = outcome;
  report.reason = reason;
  for (int i = 0; i < times; ++i) use.add(report);
}

TEST(RunUse, ARunOfUseHasNothingToSay) {
  RunUse use;
  EXPECT_FALSE(use.none());
  EXPECT_EQ(use.complaint(), "");
  add(use, 5, Outcome::kNewPlace);
  add(use, 7, Outcome::kSkipped, "the robot has not moved");
  EXPECT_EQ(use.complaint() + use.summary(), "");
  EXPECT_EQ(use.toJson().dump(), "{}");
  EXPECT_NO_THROW(use.requireSome());
}

TEST(RunUse, MoreThanHalfForOneCauseIsNoSuccess) {
  RunUse use;
  add(use, 5, Outcome::kRecognised);
  add(use, 5, Outcome::kUnusable, "too few features");
  EXPECT_EQ(use.complaint(), "") << "half is not more than half";
  add(use, 1, Outcome::kUnusable, "too few features");
  EXPECT_THAT(use.complaint(),
              AllOf(HasSubstr("6 of 11 images were of no use: too few features; "), HasSubstr("lens")));
  EXPECT_NO_THROW(use.requireSome());
  add(use, 8, Outcome::kUnusable, "the image is 320x200, the camera of the configuration 640x480");
  EXPECT_EQ(use.complaint(), "") << "no cause has more than half of 19";
  EXPECT_EQ(use.summary(),
            "  of no use: 8 (the image is 320x200, the camera of the configuration 640x480), 6 (too few "
            "features)\n");
  EXPECT_EQ(use.toJson()["too few features"], 6);
}

TEST(RunUse, RefusalsAtDifferentPlacesAreOneCause) {
  RunUse use;
  add(use, 1, Outcome::kSkipped, "the robot has not moved");
  for (int place = 0; place < 3; ++place)
    add(use, 1, Outcome::kRefused,
        "the graph refuses the closure to place " + std::to_string(place) + ": too far");
  EXPECT_THAT(use.complaint(),
              HasSubstr("3 of 4 images were of no use: the graph refuses the closure to a place; "
                        "is the odometry sound"));
  EXPECT_EQ(causeIn("visual odometry failed: too few; only 23 % of 321 matches are in one row"),
            "visual odometry failed");
  EXPECT_EQ(causeIn("no place is near"), "no place is near");
  EXPECT_EQ(causeIn(""), "no reason given");
}

TEST(RunUse, NoneUsableIsAnErrorWithTheMostFrequentCause) {
  RunUse use;
  add(use, 1, Outcome::kSkipped, "the first image");
  add(use, 2, Outcome::kUnusable, "too few features");
  add(use, 3, Outcome::kUnusable, "the right image of the stereo camera is missing");
  EXPECT_TRUE(use.none());
  try {
    use.requireSome();
    FAIL();
  } catch (const base::Error& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("none of 6 images could be used; the cause of 3: the right image"),
                                HasSubstr("[source] right_label")));
  }
}

TEST(RunUse, RefusedImagesWereLookedAt) {
  RunUse use;
  add(use, 4, Outcome::kRefused, "no place is probable enough");
  EXPECT_FALSE(use.none());
  EXPECT_THAT(use.complaint(), HasSubstr("4 of 4 images were of no use: no place is probable enough"));
  add(use, 1, Outcome::kRecognised);
  EXPECT_EQ(use.complaint(), "") << "that an image is not recognised is an answer";
  EXPECT_EQ(use.toJson()["no place is probable enough"], 4);
}

TEST(RunUse, ManyCausesAreSummedUp) {
  RunUse use;
  for (const char* reason : {"a", "b", "c", "d", "e"}) add(use, 1, Outcome::kUnusable, reason);
  EXPECT_EQ(use.summary(), "  of no use: 1 (a), 1 (b), 1 (c), 2 for other causes\n");
}

odometry::StereoHealth healthOf(odometry::StereoFault fault, int pairs) {
  odometry::StereoHealth health;
  health.fault = fault;
  health.pairs = pairs;
  return health;
}

TEST(EyeWatch, SaysAFaultOnceWhenItHasStood) {
  using odometry::StereoFault;
  EyeWatch watch;
  EXPECT_EQ(watch.after(std::nullopt), "");
  EXPECT_EQ(watch.after(healthOf(StereoFault::kUnknown, 2)), "");
  EXPECT_EQ(watch.after(healthOf(StereoFault::kSwapped, 3)), "") << "it may be chance";
  EXPECT_EQ(watch.after(healthOf(StereoFault::kNone, 8)), "");
  EXPECT_FALSE(watch.faulty());
  EXPECT_EQ(watch.after(healthOf(StereoFault::kSwapped, 10)), "");
  EXPECT_EQ(watch.after(healthOf(StereoFault::kSwapped, 17)), "");
  EXPECT_THAT(watch.after(healthOf(StereoFault::kSwapped, 18)), HasSubstr("left and right are swapped"));
  EXPECT_EQ(watch.after(healthOf(StereoFault::kSwapped, 19)), "");
  EXPECT_EQ(watch.after(healthOf(StereoFault::kSwapped, 20), true), "");
  EXPECT_TRUE(watch.faulty());
}

TEST(EyeWatch, SaysAtTheEndWhatWasNotSaid) {
  EyeWatch watch;
  EXPECT_EQ(watch.after(healthOf(odometry::StereoFault::kRows, 3)), "");
  EXPECT_THAT(watch.after(healthOf(odometry::StereoFault::kRows, 4), true), HasSubstr("not rectified"));
  EXPECT_TRUE(watch.faulty());
}

}  // namespace
}  // namespace engram::apps
