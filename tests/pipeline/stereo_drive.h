// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/pipeline/params.h"
#include "tiny_drive.h"

namespace engram::testing {

/// A few metres of the tiny building through a stereo camera of 320 x 240 pixels: of the first day, and days
/// later from farther on, with other posters and furniture. Nobody walks about. Rendered once per test
/// binary.
const DriveFrames& firstStereoDrive();
const DriveFrames& secondStereoDrive();

/// A configuration for that camera, of maps of views.
pipeline::PipelineParams stereoParams();

}  // namespace engram::testing
