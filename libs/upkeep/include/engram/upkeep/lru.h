// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/map_content.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace engram::upkeep {

using base::PlaceId;
using map::Standing;

/// A view as the rule of deletion sees it.
struct LruView {
  PlaceId id{};
  double stamp = 0;  ///< [s] when it was taken, or last matched with `touch_on_match`
  Standing standing = Standing::kConfirmed;
  bool operator==(const LruView&) const = default;
};

/// The rule of K-28, "LRU View Deletion".
struct LruRule {
  int max_views = 10;  ///< kappa: views of one neighbourhood
  double tau = 9;      ///< two views match when their closeness is at most this
  /// K-E8. A view that matches nothing where there is no room stays beside the others, on probation, until
  /// the next view comes: that one confirms it by a match, or it goes. Without, the algorithm as printed:
  /// such a view counts as the oldest for ever, and where all clusters are single it goes in the call that
  /// brought it, so that a full neighbourhood never learns a new environment.
  bool probation = true;
  bool touch_on_match = false;  ///< a match makes the matched view as recent as the new one (K-E9)
};

/// A view to be deleted.
struct LruDeletion {
  PlaceId id{};
  std::vector<PlaceId> mates{};  ///< what is left of its cluster then, rising
  bool operator==(const LruDeletion&) const = default;
};

/// What the rule makes of a neighbourhood.
struct LruPlan {
  std::vector<LruView> kept;  ///< in the order given, the new view last; with their new stamps and standings
  std::vector<LruDeletion> deleted;  ///< in the order in which they go; may name the new view
};

/// A view `added` has come to a neighbourhood: which views go (K-28 to K-31)?
///
/// Confirmed views of one neighbourhood are afterwards at most kappa, and at most one more is on probation.
/// While there are too many, the oldest view of all clusters with more than one goes, else the oldest view of
/// all. Age goes by the stamp, then by the number of the place; views that are not confirmed are older than
/// all others. Clusters are those of the moment when the view is added: a deletion does not split one. So the
/// newest view of each cluster is kept as long as there are no more than kappa clusters.
///
/// A match with the new view confirms a view that had none. With the literal rule it never becomes younger.
///
/// @param closeness one row and column for each of `views` and a last one for `added`; symmetric
/// @throws std::invalid_argument when the matrix has another size or kappa is not positive.
LruPlan planDeletion(std::span<const LruView> views, const LruView& added, const Eigen::MatrixXd& closeness,
                     const LruRule& rule);

}  // namespace engram::upkeep
