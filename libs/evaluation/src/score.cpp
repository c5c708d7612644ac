// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/score.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace engram::evaluation {

Percentiles percentiles(std::vector<double> values) {
  Percentiles out;
  if (values.empty()) return out;
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  const auto rank = [&](double share) {
    return values[static_cast<std::size_t>(std::max(1.0, std::ceil(share * n - 1e-9))) - 1];
  };
  out.count = static_cast<int>(values.size());
  out.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  out.min = values.front();
  out.median = rank(0.5);
  out.p95 = rank(0.95);
  out.max = values.back();
  return out;
}

LocalisationScore score(const std::vector<LocalisationResult>& results) {
  LocalisationScore out;
  std::vector<double> errors;
  for (const auto& result : results) {
    ++out.images;
    const bool acceptedHasTruth = result.accepted && result.verdict != Verdict::kUnknown;
    if (!acceptedHasTruth && result.bestGuess == Verdict::kUnknown) continue;
    ++out.queries;
    out.answerable += result.answerable;
    out.bestGuessRight += result.bestGuess == Verdict::kRight;
    if (result.error) errors.push_back(*result.error);
    if (!acceptedHasTruth) continue;
    ++out.accepted;
    ++(result.verdict == Verdict::kRight ? out.right : out.wrong);
  }
  out.error = percentiles(std::move(errors));
  return out;
}

}  // namespace engram::evaluation
