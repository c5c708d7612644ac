// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/features.h"

#include <opencv2/core/mat.hpp>

namespace engram::features::test {

/// SURF by dlib: the `count` strongest, less those within 16 scales of the image border, which dlib drops.
types::Features dlibSurf(const cv::Mat& grey, int count);

}  // namespace engram::features::test
