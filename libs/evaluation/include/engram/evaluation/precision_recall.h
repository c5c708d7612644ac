// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace engram::evaluation {

/// An answer to a query with how sure it is; the larger the surer, on any scale.
struct ScoredAnswer {
  double score = 0.0;
  bool right = false;
};

/// All answers with at least this score are given.
struct PrecisionRecallPoint {
  double threshold = 0.0;
  int right = 0, wrong = 0;
  double precision = 0.0;  ///< right of the given
  double recall = 0.0;     ///< right of the positives
};

struct PrecisionRecall {
  std::vector<PrecisionRecallPoint> points;  ///< one for each score, from the surest down
  /// Area under the curve as a staircase: sum of precision times the gain in recall, without interpolation.
  double auprc = 0.0;
  double recallAtFullPrecision = 0.0;  ///< the largest recall without a wrong answer
};

/// @param positives queries that have a right answer, found or not. Throws std::invalid_argument when fewer
/// than right answers.
PrecisionRecall precisionRecall(std::vector<ScoredAnswer> answers, int positives);

}  // namespace engram::evaluation
