// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/precision_recall.h"

#include "engram/base/rng.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

namespace engram::evaluation {
namespace {

TEST(PrecisionRecall, ByHand) {
  // Two positives were not answered right at all.
  const auto pr = precisionRecall({{9, true}, {8, true}, {7, false}, {5, true}, {5, false}, {1, true}}, 6);
  ASSERT_EQ(pr.points.size(), 5u);  // the two of score 5 come together
  EXPECT_DOUBLE_EQ(pr.points[1].recall, 2.0 / 6);
  EXPECT_DOUBLE_EQ(pr.points[3].precision, 3.0 / 5);
  EXPECT_DOUBLE_EQ(pr.recallAtFullPrecision, 2.0 / 6);
  EXPECT_DOUBLE_EQ(pr.auprc, (1.0 + 1.0 + 3.0 / 5 + 4.0 / 6) / 6);
  EXPECT_DOUBLE_EQ(pr.points.back().threshold, 1.0);
}

TEST(PrecisionRecall, OfNothingAndOfOnlyWrongAnswers) {
  EXPECT_TRUE(precisionRecall({}, 3).points.empty());
  EXPECT_DOUBLE_EQ(precisionRecall({}, 0).auprc, 0.0);
  const auto wrong = precisionRecall({{2, false}, {1, false}}, 3);
  EXPECT_DOUBLE_EQ(wrong.auprc, 0.0);
  EXPECT_DOUBLE_EQ(wrong.recallAtFullPrecision, 0.0);
  EXPECT_THROW(precisionRecall({{1, true}}, 0), std::invalid_argument);
}

// Every point again by counting the answers at or over its threshold.
TEST(PrecisionRecall, AgreesWithCounting) {
  base::Rng rng(4);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<ScoredAnswer> answers;
    int right = 0;
    for (int i = 0; i < 40; ++i) {
      answers.push_back({static_cast<double>(rng.below(15)), rng.uniform(0, 1) < 0.7});
      right += answers.back().right;
    }
    const int positives = right + static_cast<int>(rng.below(5));
    const auto pr = precisionRecall(answers, positives);
    std::set<double> scores;
    for (const auto& a : answers) scores.insert(a.score);
    ASSERT_EQ(pr.points.size(), scores.size());
    double full = 0, area = 0, before = 0;
    for (const auto& point : pr.points) {
      int given = 0, good = 0;
      for (const auto& a : answers) {
        given += a.score >= point.threshold;
        good += a.right && a.score >= point.threshold;
      }
      EXPECT_EQ(point.right, good);
      EXPECT_EQ(point.right + point.wrong, given);
      EXPECT_DOUBLE_EQ(point.precision, static_cast<double>(good) / given);
      EXPECT_DOUBLE_EQ(point.recall, static_cast<double>(good) / positives);
      if (good == given) full = std::max(full, point.recall);
      area += point.precision * (point.recall - before);
      before = point.recall;
    }
    EXPECT_DOUBLE_EQ(pr.recallAtFullPrecision, full);
    EXPECT_NEAR(pr.auprc, area, 1e-12);
  }
}

}  // namespace
}  // namespace engram::evaluation
