// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bench/bench_images.h"
#include "common/workplace.h"
#include "engram/pipeline/params.h"
#include "engram/types/frame.h"

#include <cstddef>
#include <string>

namespace engram::apps {

/// The frame that a robot would see at place i, or a little beside it. The places lie along a way that winds
/// to and fro, [place] spacing apart.
/// @param wheels whether it comes with odometry
types::Frame benchFrame(const BenchImages& images, const pipeline::PipelineParams& params, std::size_t i,
                        bool again, bool wheels);

/// Writes a map of so many places, each joined to the one before by an edge of odometry; one that is there
/// already, whole, is left. Throws base::Interrupted on Ctrl-C: an unfinished map is no file then.
void makeBenchMap(const BenchImages& images, const pipeline::PipelineParams& params, std::size_t places,
                  const std::string& file, const Workplace& place);

}  // namespace engram::apps
