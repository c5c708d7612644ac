// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace engram::apps {

/// NEES of the robot at one step of a drive, summed over runs that differ in their noise alone.
struct NeesStep {
  double way = 0;   ///< [m]
  double nees = 0;  ///< mean over the runs; 3 is expected
};
struct NeesFigures {
  int runs = 0;
  double low = 0, high = 0;  ///< ends of the 95 % band of that mean
  std::vector<NeesStep> steps;
  double inside() const;  ///< share of the steps in the band
};

/// The filter against the graph on the same simulated measurements.
struct SizeFigures {
  int references = 0;
  double ekfMs = 0, graphMs = 0;    ///< CPU an image, when the loop closes
  double ekfAte = 0, graphAte = 0;  ///< [m] of the references
};

/// A robot goes round a square corridor, more than once; measurements are drawn with known covariances.
NeesFigures measureNees(int runs, std::uint64_t seed);
SizeFigures compareAt(int references, std::uint64_t seed);

}  // namespace engram::apps
