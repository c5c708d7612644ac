// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/camera_rig.h"

#include <mrpt/img/TCamera.h>

namespace engram::sources {

/// The calibration as MRPT's observations hold it. MRPT knows no other camera than a pinhole without skew: of
/// others only the size is set.
mrpt::img::TCamera toMrptCamera(const cameras::CameraRig& rig);

}  // namespace engram::sources
