// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/evaluation/score.h"

#include <cstdint>
#include <map>

namespace engram::evaluation {

/// Percentiles of a series without end, such as the latencies of a run of weeks. Its memory does not grow
/// with the series: values are counted in bins, each 1 % wider than the one below it.
class RunningPercentiles {
 public:
  /// Values below 1e-6 share one bin.
  void add(double value);
  int count() const { return count_; }
  /// Count, mean, min and max are exact; median and p95 within 0.5 % for values of 1e-6 and above.
  Percentiles summary() const;

 private:
  double atRank(double share) const;

  std::map<int, std::uint64_t> bins_;  // 2,300 for values from a microsecond to three hours
  int count_ = 0;
  double sum_ = 0.0, min_ = 0.0, max_ = 0.0;
};

}  // namespace engram::evaluation
