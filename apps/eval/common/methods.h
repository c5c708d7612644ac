// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/contender.h"

#include <vector>

namespace engram::apps {

/// The ways of remembering that are compared (F-27, F-E21, D-13, F-31).
std::vector<Method> comparedMethods(const pipeline::PipelineParams& pipeline, int bowWords);
/// The adaptive memory of D-08 in both settings, FSH, and the baselines.
std::vector<Method> touredMethods(const pipeline::PipelineParams& pipeline);
/// FSH, the adaptive memory of D-08, and none (F-24).
std::vector<Method> staticPlaceMethods(const pipeline::PipelineParams& pipeline);
/// FSH with prune_view from 1 to 7 and with ltm_threshold from 0.1 to 0.9 (F-23).
std::vector<Method> sweptMethods(const pipeline::PipelineParams& pipeline);

}  // namespace engram::apps
