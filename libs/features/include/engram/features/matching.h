// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/types/features.h"
#include "engram/types/match.h"

#include <vector>

namespace engram::features {

/// When two features correspond: section `[matching]`.
struct MatchParams {
  double ratio = 0.8;
  bool mutual = true;
  double max_distance = 0.0;

  void describe(base::Params& p);
};

/// One-to-one correspondences between two sets, by rising `a`.
///
/// The nearest feature of b is sought for each of a (ties: the lower index). It is a match when
///  - d1 < ratio * d2, d2 the distance of the second nearest (Lowe 2004); without a second nearest nothing
///  tells a match
///    from chance, and there is none. A ratio of 1 switches the test off;
///  - with `mutual`, a is the nearest of b as well; without, the nearest of all that chose this b (ties: the
///  lower index).
///
/// When all features of both sets carry a sign of the Laplacian, only features of equal sign are compared,
/// and d2 is sought among these. A kFloat set against a kInt8 one is quantised first.
/// @throws std::invalid_argument when the descriptors are of another kind or dimension.
std::vector<types::Match> match(const types::Features& a, const types::Features& b,
                                const MatchParams& params);

}  // namespace engram::features
