// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/evaluation/truth.h"

#include <optional>
#include <vector>

namespace engram::evaluation {

/// Of a sample; all 0 for an empty one. Percentiles by nearest rank: the smallest value with at least that
/// share of the sample at or below it.
struct Percentiles {
  int count = 0;
  double mean = 0, min = 0, median = 0, p95 = 0, max = 0;
};
Percentiles percentiles(std::vector<double> values);

/// What became of one located image, for the score.
struct LocalisationResult {
  bool accepted = false;
  bool answerable = true;                 ///< Truth::answerable()
  Verdict verdict = Verdict::kUnknown;    ///< of the place accepted; not looked at when none was
  Verdict bestGuess = Verdict::kUnknown;  ///< of the maximum of the posterior, accepted or not
  std::optional<double> error;  ///< of the best guess, in the unit of the caller (places, frames, metres)
};

/// The figures of a localisation run. Queries that the truth says nothing about count in `images` only.
struct LocalisationScore {
  int images = 0;
  int queries = 0;           ///< with truth
  int answerable = 0;        ///< of those, images that show a place of the truth at all
  int accepted = 0;          ///< of the queries
  int right = 0, wrong = 0;  ///< of the accepted
  int bestGuessRight = 0;    ///< of the queries, by the maximum of the posterior
  Percentiles error;         ///< of the best guesses that have one

  double precision() const { return accepted > 0 ? static_cast<double>(right) / accepted : 0.0; }
  double recall() const { return answerable > 0 ? static_cast<double>(right) / answerable : 0.0; }
};

LocalisationScore score(const std::vector<LocalisationResult>& results);

}  // namespace engram::evaluation
