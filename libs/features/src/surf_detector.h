// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cpu.h"
#include "engram/types/features.h"
#include "integral_image.h"

#include <vector>

namespace engram::features {

struct SurfDetectorParams {
  double threshold = 5e-5;  ///< smallest determinant of the Hessian, for grey values in [0, 1]
  int octaves = 4;
  int step = 1;  ///< sampling of the first octave [px]; doubles with each octave
};

/// Side of SURF's descriptor window in units of its scale, and so Keypoint::size / scale.
inline constexpr float kSurfWindow = 24.0f;

/// Interest points of the fast Hessian detector (Bay, Ess, Tuytelaars & Van Gool 2008, section 3): box-filter
/// Hessian, maxima among 3×3×3 neighbours, quadratic fit in place and scale. Angles are 0; the order is by
/// octave, row, column. All levels give the same bits.
std::vector<types::Keypoint> detectSurf(SimdLevel level, const IntegralImage& image,
                                        const SurfDetectorParams& params);

}  // namespace engram::features
