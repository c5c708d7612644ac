// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/upkeep/upkeep.h"

#include "engram/base/error.h"
#include "engram/upkeep/clusters.h"
#include "surgery.h"

#include <algorithm>

namespace engram::upkeep {
namespace {

LruView lruView(const map::Place& place) {
  return {place.id, place.matchedStamp.value_or(place.createdStamp), place.standing};
}

/// K eq (4) for each pair; the diagonal is left at zero.
Eigen::MatrixXd closenessOf(const map::TopologicalMap& map, std::span<const PlaceId> places,
                            const Inliers& inliers) {
  const auto n = static_cast<Eigen::Index>(places.size());
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(n, n);
  const auto features = [&](PlaceId id) { return static_cast<int>(map.place(id).memory->features.size()); };
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < i; ++j) {
      const PlaceId a = places[static_cast<std::size_t>(i)], b = places[static_cast<std::size_t>(j)];
      c(i, j) = c(j, i) = closeness(std::min(features(a), features(b)), inliers(a, b));
    }
  return c;
}

void remove(map::TopologicalMap& map, const RemoveView& edit, Applied& done) {
  Mending mending = mend(map, edit.place, edit.mates);
  if (!mending.heir.valid())
    throw base::Error("place " + std::to_string(edit.place.value) +
                      " cannot be removed: no edge joins it to another one that could take its part");
  Applied::Removed gone{edit.place, mending.heir, map.viewsOf(edit.place), {}};
  gone.T_heir_place = map.place(mending.heir).T_map_place.inverse() * map.place(edit.place).T_map_place;
  for (map::Edge& bridge : mending.bridges) done.bridges.push_back(map.addEdge(std::move(bridge)));
  map.removePlace(edit.place, mending.heir);
  done.removed.push_back(std::move(gone));
}

}  // namespace

void UpkeepParams::describe(base::Params& p) {
  p.addChoice("upkeep", upkeep,
              "what is forgotten: lru_views, views that a neighbourhood has no room for; or none",
              {"lru_views", "none"});
  p.add("max_views", max_views, "views that a neighbourhood keeps (kappa of Konolige & Bowman)", {1, 1000});
  p.add("neighbourhood_distance", neighbourhood_distance, "[m] views nearer than this share a neighbourhood",
        {0.001, 1000});
  p.addDegrees("neighbourhood_angle", neighbourhood_angle,
               "[deg] when their directions differ by at most this too", {0.1, 180});
  p.add("search_distance", search_distance, "[m] the search for neighbours goes no farther from the view",
        {0.001, 10000});
  p.add("search_sigma", search_sigma,
        "[m] standard deviation up to which a chain of edges tells what is near", {0.001, 10000});
  p.add("max_closeness", max_closeness,
        "two views match up to this value of features / inliers - 1 (tau); 0 asks what recognition asks",
        {0, 1e6});
  p.add("view_features", view_features, "features of a usual view, for max_closeness = 0", {1, 100000});
  p.add("probation", probation,
        "a view that matches nothing in a full neighbourhood stays until the next one; false: as printed");
  p.add("touch_on_match", touch_on_match,
        "a view that is matched counts as new; false: age is that of the image");
  p.add("keep_drives", keep_drives,
        "earlier drives whose path and records of images stay in the map; 0: all of them", {0, 1e6});
}

Budget UpkeepParams::budget(int recognitionInliers) const {
  if (max_closeness <= 0 && recognitionInliers > view_features)
    throw base::ConfigError("[upkeep] view_features = " + std::to_string(view_features) +
                            " is less than the " + std::to_string(recognitionInliers) +
                            " inliers that recognition wants: no view could match another");
  return {{.max_views = max_views,
           .tau = max_closeness > 0 ? max_closeness : closeness(view_features, recognitionInliers),
           .probation = probation,
           .touch_on_match = touch_on_match},
          {.distance = neighbourhood_distance,
           .angle = neighbourhood_angle,
           .search_distance = search_distance,
           .search_sigma = search_sigma}};
}

Inliers edgeInliers(const map::TopologicalMap& map) {
  return [&map](PlaceId a, PlaceId b) {
    std::size_t most = 0;
    for (const map::Neighbour& n : map.neighbours(a))
      if (n.place == b) most = std::max(most, map.edge(n.edge).correspondences.size());
    return static_cast<int>(most);
  };
}

std::vector<Edit> plan(const map::TopologicalMap& map, PlaceId added, const Budget& budget,
                       const Inliers& inliers) {
  std::vector<PlaceId> places;
  std::vector<LruView> views;
  for (const NearPlace& near : neighbourhood(map, added, budget.near)) {
    places.push_back(near.place);
    views.push_back(lruView(map.place(near.place)));
  }
  places.push_back(added);
  const LruPlan lru =
      planDeletion(views, lruView(map.place(added)), closenessOf(map, places, inliers), budget.rule);

  std::vector<Edit> edits;
  for (const LruView& kept : lru.kept) {
    const map::Place& place = map.place(kept.id);
    SetStanding edit{kept.id, kept.standing, place.matchedStamp};
    if (kept.stamp != lruView(place).stamp) edit.matchedStamp = kept.stamp;
    if (edit != SetStanding{kept.id, place.standing, place.matchedStamp}) edits.emplace_back(edit);
  }
  for (const LruDeletion& deletion : lru.deleted) edits.emplace_back(RemoveView{deletion.id, deletion.mates});
  return edits;
}

Applied apply(map::TopologicalMap& map, const std::vector<Edit>& edits) {
  Applied done;
  for (const Edit& edit : edits) {
    if (const auto* standing = std::get_if<SetStanding>(&edit))
      map.setStanding(standing->place, standing->standing, standing->matchedStamp);
    else
      remove(map, std::get<RemoveView>(edit), done);
  }
  return done;
}

}  // namespace engram::upkeep
