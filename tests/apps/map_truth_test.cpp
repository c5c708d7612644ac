// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/map_truth.h"

#include "engram/base/atomic_file.h"
#include "tiny_drive.h"

#include <gtest/gtest.h>

#include <string>

namespace engram::apps {
namespace {

/// A view may be forgotten by the image that brought it: there is nothing left to survey then.
TEST(MapTruth, SurveysPlacesThatTheMapStillHas) {
  const std::string path = ::testing::TempDir() + "map_truth_test.tum";
  const types::Frame& frame = testing::firstDrive().frames.front();
  const auto line = [&](double after) { return std::to_string(frame.stamp + after) + " 1 2 0 0 0 0 1\n"; };
  base::writeText(path, line(-0.05) + line(0.05), true);
  MapTruth truth(path, {});
  pipeline::Pipeline mapper(testing::tinyParams());
  types::FrameReport report = mapper.process(frame);
  ASSERT_EQ(report.outcome, types::Outcome::kNewPlace);
  truth.survey(mapper, report);
  EXPECT_TRUE(mapper.map().place(report.place).T_world_place.has_value());
  report.place = base::PlaceId(9);
  EXPECT_NO_THROW(truth.survey(mapper, report));
}

}  // namespace
}  // namespace engram::apps
