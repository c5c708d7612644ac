// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/config.h"
#include "engram/cameras/stereo_rig.h"

#include <optional>
#include <string>

namespace engram::cameras {

/// Does the file hold a section that ends in `_LEFT2RIGHT_POSE`, as those of mrpt::img::TStereoCamera do?
bool isMrptStereo(const base::IniFile& ini);

/// Reads it as MRPT does (TStereoCamera::loadFromConfigFile), but strictly, with [mount] where it is given.
StereoRig readMrptStereo(const base::IniFile& ini);

/// The one camera of a file of mrpt::img::TCamera: a section of any name but [camera] that has `resolution`.
/// None when the file is no such one.
std::optional<CameraRig> readMrptCamera(const base::IniFile& ini);

std::string mrptStereoText(const StereoRig& rig);

}  // namespace engram::cameras
