// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/error.h"
#include "engram/keeper/edits.h"
#include "place_pairs.h"

#include <algorithm>

namespace engram::keeper {

Relaxed relax(store::WholeMap& map, const pipeline::PipelineParams& params) {
  if (params.mapping.nodes == "scans")
    throw base::Error("this is a map of scans: a filter keeps its poses, and no graph is relaxed");
  std::map<map::PlaceId, Eigen::Isometry3d> before;
  for (const auto& [id, place] : map.content.places) before[id] = place.T_map_place;
  Relaxed done;
  done.dropped = relaxAll(map.content, params).size();
  for (const auto& [id, T] : before) {
    const double moved = (map.content.places.at(id).T_map_place.translation() - T.translation()).norm();
    done.moved += moved / static_cast<double>(before.size());
    done.movedMost = std::max(done.movedMost, moved);
  }
  return done;
}

}  // namespace engram::keeper
