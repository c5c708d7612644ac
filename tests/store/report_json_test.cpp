// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/store/report_json.h"

#include "store_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace engram::store {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ReportJson, HasTheDocumentedKeys) {
  EXPECT_EQ(
      toJson(sampleReport()),
      R"({"index":42,"stamp":1700000000.25,"label":"img_\"042\".png","outcome":"recognised",)"
      R"("reason":"too few inliers: 11 of 30","features":512,"place":3,"best_guess":4,)"
      R"("best_guess_interpolated":3.4,"new_place_probability":0.1,)"
      R"("pose":{"x":1.5,"y":-2.25,"heading":0.5,"sigma_along":0.04,"sigma_across":0.03,"sigma_heading":0.02},)"
      R"("hypotheses":[)"
      R"({"place":3,"similarity":0.8,"posterior":0.7,"inliers":120},)"
      R"({"place":4,"similarity":0.3,"posterior":0.1,"inliers":-1}],"closure":true,)"
      R"("closures_dropped":1,"closures_restored":2,)"
      R"("learnt":[3,9],)"
      R"("memory":{"rehearsed":1,"added":2,"pruned":3,"promoted":4,"demoted":5,"long_term":6,"short_term":7},)"
      R"("times":{"perceive":5.5,"recognise":1.25},"ms":8.5})");
  EXPECT_THAT(toJson(sampleReport(), false), Not(HasSubstr("\"ms\"")));
  EXPECT_THAT(toJson(sampleReport(), false), Not(HasSubstr("times")));
}

TEST(ReportJson, RoundTrips) {
  EXPECT_EQ(toJson(reportFromJson(toJson(sampleReport()))), toJson(sampleReport()));
  const types::FrameReport empty;
  EXPECT_EQ(toJson(reportFromJson(toJson(empty))), toJson(empty));
  EXPECT_FALSE(reportFromJson(toJson(empty)).place.valid());
}

TEST(ReportJson, SaysWhatAPlaceWasAcceptedByAndItsRival) {
  types::FrameReport r = sampleReport();
  EXPECT_THAT(toJson(r), Not(HasSubstr("accepted_by")));
  r.acceptedBy = types::AcceptedBy::kSequence;
  r.rival = base::PlaceId(7);
  EXPECT_THAT(toJson(r), HasSubstr(R"("accepted_by":"sequence","rival":7)"));
  const types::FrameReport back = reportFromJson(toJson(r));
  EXPECT_EQ(back.acceptedBy, types::AcceptedBy::kSequence);
  EXPECT_EQ(back.rival, base::PlaceId(7));
  EXPECT_THROW(reportFromJson(R"({"accepted_by":"luck"})"), base::Error);
}

TEST(ReportJson, LiveStateIsOfTheRunAndNotOfTheMap) {
  types::FrameReport r = sampleReport();
  r.live = types::LiveState{17.5, 1, 2, 3, 4};
  EXPECT_THAT(toJson(r),
              HasSubstr(R"("live":{"latency_ms":17.5,"waiting":1,"incomplete":2,"missed":3,"dropped":4})"));
  EXPECT_EQ(toJson(reportFromJson(toJson(r))), toJson(r));
  EXPECT_EQ(toJson(r, false), toJson(sampleReport(), false));
  EXPECT_FALSE(reportFromJson(toJson(sampleReport())).live);
}

TEST(ReportJson, SurvivesStrangeValues) {
  types::FrameReport r = sampleReport();
  r.stamp = std::numeric_limits<double>::quiet_NaN();
  r.label = "caf\xe9\n\x01";
  const std::string line = toJson(r);
  EXPECT_THAT(line, HasSubstr("\"stamp\":null"));
  EXPECT_EQ(line.find('\n'), std::string::npos);
  EXPECT_TRUE(std::isnan(reportFromJson(line).stamp));
  for (const char* bad :
       {"", "[]", "{", "{\"outcome\":\"lost\"}", "{\"index\":\"x\"}", "{\"hypotheses\":[3]}",
        "{\"times\":{\"a\":\"b\"}}", "{\"memory\":7}", "{\"live\":7}"})
    EXPECT_THROW(reportFromJson(bad), base::Error) << bad;
  EXPECT_EQ(reportFromJson("{\"future\":1,\"index\":5}").index, 5u);
}

}  // namespace
}  // namespace engram::store
