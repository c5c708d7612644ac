// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/precision_recall.h"

#include <algorithm>
#include <stdexcept>

namespace engram::evaluation {

PrecisionRecall precisionRecall(std::vector<ScoredAnswer> answers, int positives) {
  std::sort(answers.begin(), answers.end(),
            [](const ScoredAnswer& a, const ScoredAnswer& b) { return a.score > b.score; });
  PrecisionRecall out;
  PrecisionRecallPoint point;
  double before = 0.0;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    ++(answers[i].right ? point.right : point.wrong);
    if (i + 1 < answers.size() && answers[i + 1].score == answers[i].score) continue;
    point.threshold = answers[i].score;
    point.precision = static_cast<double>(point.right) / (point.right + point.wrong);
    point.recall = positives > 0 ? static_cast<double>(point.right) / positives : 0.0;
    out.auprc += point.precision * (point.recall - before);
    if (point.wrong == 0) out.recallAtFullPrecision = point.recall;
    before = point.recall;
    out.points.push_back(point);
  }
  if (point.right > positives)
    throw std::invalid_argument("precisionRecall: more right answers than positives");
  return out;
}

}  // namespace engram::evaluation
