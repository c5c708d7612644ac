// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/pipeline/params.h"
#include "engram/pipeline/perception.h"
#include "snapshot.h"

#include <vector>

namespace engram::viewer {

/// Finds the features of an image again and holds them against the memory of its place, in the thread of the
/// window: the run keeps no features of its own for us.
class Annotator {
 public:
  explicit Annotator(const pipeline::PipelineParams& params)
      : params_(params), perception_(params.camera, params.extractor) {}

  /// Long-term and short-term features are those that the place remembers after this image.
  std::vector<Mark> marks(const Snapshot& snapshot);

 private:
  pipeline::PipelineParams params_;
  pipeline::Perception perception_;
};

}  // namespace engram::viewer
