// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "panel.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace engram::viewer {
namespace {

using types::Outcome;

const cv::Size kSize(640, 760);

int pixelsOf(const cv::Mat& panel, const cv::Rect& box, const cv::Scalar& colour, int tolerance = 12) {
  cv::Mat mask;
  const cv::Scalar t = cv::Scalar::all(tolerance);
  cv::inRange(panel(box), colour - t, colour + t, mask);
  return cv::countNonZero(mask);
}

PanelContent sample() {
  PanelContent content;
  content.image = cv::Mat(480, 640, CV_8UC1, cv::Scalar(100));
  content.matched = cv::Mat(96, 128, CV_8UC3, cv::Scalar(200, 10, 200));
  content.state = RobotState::kTracking;
  content.places = 10;
  content.report.place = base::PlaceId(2);
  content.report.hypotheses = {{base::PlaceId(2), 0.5, 0.8, 40}, {base::PlaceId(7), 0.2, 0.1, -1}};
  return content;
}

const cv::Rect kImage(0, 38, 640, 481), kMatched(0, 519, 320, 241), kBelief(320, 519, 320, 241);
const cv::Scalar kGreen(80, 220, 80), kOrange(40, 160, 255);

TEST(Panel, ShowsImageAndMatchedViewBesideEachOther) {
  const cv::Mat panel = drawPanel(sample(), kSize);
  ASSERT_EQ(panel.size(), kSize);
  ASSERT_EQ(panel.type(), CV_8UC3);
  EXPECT_GT(pixelsOf(panel, kImage, {100, 100, 100}), 640 * 470);
  EXPECT_GT(pixelsOf(panel, kMatched, {200, 10, 200}), 128 * 96);
}

TEST(Panel, LongTermIsGreenAndShortTermOrange) {
  PanelContent content = sample();
  content.marks = {{{100, 100}, 10, Mark::Kind::kLongTerm}, {{300, 200}, 10, Mark::Kind::kShortTerm}};
  const cv::Mat panel = drawPanel(content, kSize);
  const auto around = [](float x, float y) {
    return cv::Rect(static_cast<int>(x) - 8, static_cast<int>(y) + 30, 16, 16);
  };
  constexpr int kBlurred = 60;  // the circles are thin and their edges soft
  EXPECT_GT(pixelsOf(panel, around(100, 100), kGreen, kBlurred), 5);
  EXPECT_EQ(pixelsOf(panel, around(100, 100), kOrange, kBlurred), 0);
  EXPECT_GT(pixelsOf(panel, around(300, 200), kOrange, kBlurred), 5);
  EXPECT_EQ(pixelsOf(panel, around(300, 200), kGreen, kBlurred), 0);
}

TEST(Panel, BarsStandForProbabilities) {
  PanelContent content = sample();
  const auto green = [&](double posterior) {
    content.report.hypotheses[0].posterior = posterior;
    return pixelsOf(drawPanel(content, kSize), kBelief, kGreen);
  };
  const int low = green(0.2), high = green(0.8);
  EXPECT_NEAR(1.0 * high / low, 4.0, 0.4);
  EXPECT_EQ(green(0.0), 0);
  // The bar of place 2 of 10 is left of the middle, the new place is at the right end.
  content.report.hypotheses[0].posterior = 0.8;
  content.report.newPlaceProbability = 0.6;
  const cv::Mat panel = drawPanel(content, kSize);
  const cv::Rect left(kBelief.x, kBelief.y, kBelief.width / 2, kBelief.height);
  const cv::Rect right(kBelief.x + kBelief.width * 3 / 4, kBelief.y, kBelief.width / 4, kBelief.height);
  EXPECT_EQ(pixelsOf(panel, left, kGreen), pixelsOf(panel, kBelief, kGreen));
  EXPECT_GT(pixelsOf(panel, right, {255, 170, 60}), 100);
}

TEST(Panel, TheStateHasItsColour) {
  PanelContent content = sample();
  const cv::Rect bar(250, 4, 100, 30);
  content.state = RobotState::kLost;
  EXPECT_GT(pixelsOf(drawPanel(content, kSize), bar, {50, 50, 200}), 2000);
  content.state = RobotState::kTracking;
  EXPECT_GT(pixelsOf(drawPanel(content, kSize), bar, {70, 170, 70}), 2000);
}

TEST(Panel, StandsEmptyAndStrangeContent) {
  EXPECT_NO_THROW(drawPanel({}, kSize));
  PanelContent content = sample();
  content.image = cv::Mat(2000, 100, CV_8UC3, cv::Scalar::all(9));
  content.marks = {{{-50, 5000}, 300, Mark::Kind::kLongTerm}};
  content.report.hypotheses[0].place = base::PlaceId(5000);
  content.report.hypotheses[0].posterior = 7.0;
  content.report.reason = std::string(500, 'x');
  content.places = 0;
  EXPECT_NO_THROW(drawPanel(content, kSize));
}

TEST(RobotState, FollowsTheOutcome) {
  types::FrameReport report;
  const auto after = [&](Outcome outcome, RobotState before) {
    report.outcome = outcome;
    return stateAfter(report, before);
  };
  EXPECT_EQ(after(Outcome::kNewPlace, RobotState::kBlind), RobotState::kNewPlace);
  EXPECT_EQ(after(Outcome::kSkipped, RobotState::kNewPlace), RobotState::kNewPlace);
  EXPECT_EQ(after(Outcome::kRecognised, RobotState::kNewPlace), RobotState::kTracking);
  EXPECT_EQ(after(Outcome::kRefused, RobotState::kTracking), RobotState::kLost);
  EXPECT_EQ(after(Outcome::kUnusable, RobotState::kTracking), RobotState::kBlind);
}

}  // namespace
}  // namespace engram::viewer
