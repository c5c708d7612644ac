// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"

#include <span>

namespace engram::evaluation {

struct BootstrapParams {
  int resamples = 2000;
  double confidence = 0.95;
  int seed = 1;

  void describe(base::Params& p);
};

/// A figure with the range in which its true value lies at the asked confidence.
struct Interval {
  double value;    ///< of all samples; NaN without samples
  double low;      ///< NaN when there are fewer than two blocks: the spread is not known then
  double high;     ///< as low
  int blocks = 0;  ///< that carry samples; what the width rests on

  bool known() const { return blocks >= 2; }
  /// Whether `truth` can be ruled out. Never when the interval is not known.
  bool excludes(double truth) const { return known() && (truth < low || truth > high); }
};

/// One measured item. Items of a block (a tour, a stretch of a drive, a random sequence) may depend on each
/// other; blocks do not.
struct BlockSample {
  int block = 0;
  double value = 0.0;
  double weight = 1.0;  ///< 0 leaves the sample out
};

/// Weighted mean over all samples with the percentile interval of the cluster bootstrap: whole blocks are
/// drawn with replacement (Efron & Tibshirani 1993, ch. 8 and 13). The percentiles are the expanded ones of
/// Hesterberg 2015, section 3.3, which keep the confidence with few blocks. Samples that are all equal give
/// an interval of no width, which says that no variation was seen, not that there is none; for shares see
/// blockBootstrapShare(). Throws base::Error for a value that is not finite and for a negative weight.
Interval blockBootstrapMean(std::span<const BlockSample> samples, const BootstrapParams& params = {});

/// The same for values within 0 .. 1 (1: success). Where all are 0, or all 1, no resample differs and the far
/// end is the exact bound instead: with n independent blocks and error α, a share above 1 - (α/2)^(1/n) would
/// have shown itself (Clopper & Pearson 1934 with a block as the unit; safe for blocks of like weight).
Interval blockBootstrapShare(std::span<const BlockSample> samples, const BootstrapParams& params = {});

/// Mean of a - b for two methods on the same items. `a` and `b` must agree in length and, item by item, in
/// block and weight; base::Error names the first item that does not. An item that both methods solve or miss
/// adds no spread, so that this is narrower than what the two single intervals suggest.
Interval blockBootstrapDifference(std::span<const BlockSample> a, std::span<const BlockSample> b,
                                  const BootstrapParams& params = {});

}  // namespace engram::evaluation
