// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace engram::base {

/// Seeded random numbers that are the same on every machine (xoshiro256**, Blackman & Vigna 2018).
/// The distributions are our own because those of <random> differ between standard libraries.
class Rng {
 public:
  explicit Rng(std::uint64_t seed);

  /// An independent stream for a named purpose; does not advance this one.
  Rng fork(std::uint64_t stream) const;

  std::uint64_t bits();
  /// Uniform in [0, 1).
  double uniform();
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in 0 .. n-1, without modulo bias. n > 0.
  std::uint32_t below(std::uint32_t n);
  /// Standard normal (polar method).
  double normal();
  double normal(double mean, double sigma) { return mean + sigma * normal(); }

 private:
  std::uint64_t state_[4];
};

}  // namespace engram::base
