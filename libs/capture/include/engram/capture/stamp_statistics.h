// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace engram::capture {

/// Rate, jitter and gaps of a series of images, by their stamps alone.
class StampStatistics {
 public:
  struct Gap {
    double from = 0.0;        ///< stamp of the image before it [s]
    double length = 0.0;      ///< to the next image [s]
    std::size_t missing = 0;  ///< images that would have fitted in
  };
  struct Summary {
    std::size_t images = 0;
    double first = 0.0, last = 0.0;          ///< [s]
    double rate = 0.0;                       ///< images over time [1/s]; 0 with fewer than two
    double interval = 0.0;                   ///< of a whole series; the median where there is none [s]
    double jitter = 0.0;                     ///< median absolute deviation from its multiples [s]
    double interval95 = 0.0, longest = 0.0;  ///< 95th percentile and maximum [s]
    std::vector<Gap> gaps;                   ///< 1.5 intervals and more
    std::size_t missing = 0;                 ///< of all gaps
  };

  /// Stamps [s] should rise; others are counted as images but not as intervals.
  void add(double stamp);
  Summary summary() const;

 private:
  std::vector<double> stamps_;
};

}  // namespace engram::capture
