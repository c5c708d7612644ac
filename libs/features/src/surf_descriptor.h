// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cpu.h"
#include "engram/types/features.h"
#include "integral_image.h"

namespace engram::features {

inline constexpr int kSurfDim = 64;

/// Dominant direction of the Haar responses within 6 scales, x to y [rad] (Bay 2008, section 4.1).
float surfAngle(SimdLevel level, const IntegralImage& image, const types::Keypoint& keypoint);

/// Sums of dx, dy, |dx|, |dy| in 4×4 cells of the window turned by the keypoint's angle, unit norm (Bay 2008,
/// section 4.2, with the overlapping cells of Agrawal, Konolige & Blas 2008). All zeros on a window without
/// texture. Haar filters that reach over the image border count as 0.
void surfDescriptor(SimdLevel level, const IntegralImage& image, const types::Keypoint& keypoint,
                    float out[kSurfDim]);

}  // namespace engram::features
