// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/pipeline/params.h"
#include "engram/store/whole_map.h"
#include "joint.h"

namespace engram::keeper {

/// The place `joint.b` becomes one with `joint.a`, both of one map: memory, views, edges, path and records.
/// @param eye where the camera is on the robot [m]
void unifyPlaces(store::WholeMap& map, const Joint& joint, const pipeline::PipelineParams& params,
                 const Eigen::Vector3d& eye);

}  // namespace engram::keeper
