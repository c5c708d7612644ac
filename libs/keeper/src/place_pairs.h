// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/keeper/configuration.h"
#include "engram/memory/place_memory.h"
#include "engram/pipeline/perception.h"
#include "engram/pipeline/place_match.h"
#include "engram/types/rel_pose.h"

namespace engram::keeper {

/// Holds what two places remember against each other, as if one were an image of the other.
class PlacePairs {
 public:
  explicit PlacePairs(const Configuration& configuration);

  /// @param view the place that is taken for an image; a of each match is a feature of it
  pipeline::PlaceMatch match(const memory::PlaceMemory& view, const memory::PlaceMemory& place) const;
  /// Where the viewing place is, seen from the other, as far as the match tells.
  types::RelPose T_place_view(const pipeline::PlaceMatch& match) const;
  const pipeline::PipelineParams& params() const { return configuration_.params; }
  /// Where the camera is on the robot [m].
  Eigen::Vector3d eye() const { return perception_.eye(); }
  const std::optional<pipeline::StereoCamera>& stereo() const { return perception_.stereo(); }

 private:
  Configuration configuration_;
  pipeline::Perception perception_;
};

/// Relaxes as at the end of a drive. Returns the closures that the graph denies now: they are taken out.
std::vector<map::EdgeId> relaxAll(map::MapContent& content, const pipeline::PipelineParams& params);

}  // namespace engram::keeper
