// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/map/topological_map.h"
#include "engram/upkeep/lru.h"
#include "engram/upkeep/neighbourhood.h"

#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace engram::upkeep {

/// What the map may keep, and where.
struct Budget {
  LruRule rule;
  NeighbourhoodParams near;
};

/// Section `[upkeep]`: what is forgotten so that a map stays bounded.
struct UpkeepParams {
  std::string upkeep = "none";                ///< `lru_views`: K-28; `none`: every view stays
  int max_views = 10;                         ///< kappa
  double neighbourhood_distance = 0.5;        ///< [m] (K-27)
  double neighbourhood_angle = 0.1745329252;  ///< [rad] (K-27)
  double search_distance = 2.0;               ///< [m]
  double search_sigma = 1.0;                  ///< [m]
  double max_closeness = 0.0;                 ///< tau; 0: see budget()
  int view_features = 300;
  bool probation = true;
  bool touch_on_match = false;
  int keep_drives = 0;

  void describe(base::Params& p);
  /// The paper gives no tau. Ours asks what place recognition asks (K-E6): m / m_e - 1 with the usual number
  /// of features `view_features` and the inliers that recognition wants, 9 for 300 and 30.
  /// @throws base::ConfigError when it wants more inliers than a view has features.
  Budget budget(int recognitionInliers) const;
};

/// Inliers m_e of the match of two places; 0 when they do not match or nobody tried.
using Inliers = std::function<int(PlaceId, PlaceId)>;

/// By the correspondences that the edges of the map hold. Refers to the map.
Inliers edgeInliers(const map::TopologicalMap& map);

/// A place stands otherwise with the rules from now on.
struct SetStanding {
  PlaceId place{};
  Standing standing = Standing::kConfirmed;
  std::optional<double> matchedStamp{};
  bool operator==(const SetStanding&) const = default;
};

/// A view is deleted. In a view map every place holds one view (K: nodes are views), so the place goes with
/// it: memory, edges and all.
struct RemoveView {
  PlaceId place{};
  std::vector<PlaceId> mates{};  ///< what is left of its cluster
  bool operator==(const RemoveView&) const = default;
};

using Edit = std::variant<SetStanding, RemoveView>;

/// What is to be done after a view was added and linked to all that it matches (K-19, 5 ii C). Changes
/// nothing; the same map gives the same edits. The work depends on the neighbourhood, not on the map.
///
/// Stamps are times of acquisition. A drive that is older than the map, as when sequences are replayed in
/// another order (K-35), may therefore see its own newest view go: the robot must then be tied to the heir
/// that apply() names.
/// @throws base::Error when there is no such place.
std::vector<Edit> plan(const map::TopologicalMap& map, PlaceId added, const Budget& budget,
                       const Inliers& inliers);

/// What apply() did, for those who keep something beside the map: vocabulary, scorer, belief, robot.
struct Applied {
  struct Removed {
    PlaceId place, heir;
    std::vector<map::ViewId> views;
    Eigen::Isometry3d T_heir_place;
  };
  std::vector<Removed> removed;
  std::vector<map::EdgeId> bridges;
};

/// Does it, in the order given; see mend() for the graph.
/// @throws base::Error for an unknown place, or one to be removed that no edge joins to another: the edits
/// before it are then done.
Applied apply(map::TopologicalMap& map, const std::vector<Edit>& edits);

}  // namespace engram::upkeep
