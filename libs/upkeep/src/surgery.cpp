// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "surgery.h"

#include "certainty.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace engram::upkeep {
namespace {

/// The best edge from the place that goes to one of its neighbours.
struct Arm {
  PlaceId to;
  types::RelPose T_gone_to;
  bool weak = false;   ///< no passage: a guess, or odometry over known ground
  bool guess = false;  ///< a weak edge proper (K-11)
  bool mate = false;
  double variance = 0;

  /// Less is better: the heir is the first.
  auto rank() const { return std::tuple(weak, guess, !T_gone_to.hasScale, !mate, variance, to); }
};

/// One for each neighbour, best first.
std::vector<Arm> armsOf(const map::TopologicalMap& map, PlaceId gone, const std::set<PlaceId>& mates) {
  std::map<PlaceId, Arm> best;
  for (const map::Neighbour& n : map.neighbours(gone)) {
    Arm arm{n.place, seenFrom(gone, map.edge(n.edge)), !map::isPassage(n.type),
            n.type == map::EdgeType::kWeak, mates.contains(n.place)};
    arm.variance = variance(arm.T_gone_to);
    const auto [known, isNew] = best.try_emplace(n.place, arm);
    if (!isNew && arm.rank() < known->second.rank()) known->second = arm;
  }
  std::vector<Arm> arms;
  for (const auto& [place, arm] : best) arms.push_back(arm);
  std::sort(arms.begin(), arms.end(), [](const Arm& a, const Arm& b) { return a.rank() < b.rank(); });
  return arms;
}

/// What hangs together with the heir by itself: it, and mates that normal edges join to it.
class Trunk {
 public:
  Trunk(const map::TopologicalMap& map, const std::set<PlaceId>& mates) : map_(map), mates_(mates) {}

  void grow(PlaceId from) {
    if (!places_.insert(from).second) return;
    for (const map::Neighbour& n : map_.neighbours(from))
      if (map::isPassage(n.type) && mates_.contains(n.place)) grow(n.place);
  }

  /// Is the neighbour linked to it already, by an edge that is not worse than the one that goes?
  bool holds(const Arm& arm) const {
    if (places_.contains(arm.to)) return true;
    const auto neighbours = map_.neighbours(arm.to);
    return std::any_of(neighbours.begin(), neighbours.end(), [&](const map::Neighbour& n) {
      return places_.contains(n.place) && (arm.weak || map::isPassage(n.type));
    });
  }

 private:
  const map::TopologicalMap& map_;
  const std::set<PlaceId>& mates_;
  std::set<PlaceId> places_;
};

map::Edge bridge(const Arm& heir, const Arm& arm, std::size_t uses) {
  types::RelPose T_gone_heir = heir.T_gone_to;
  T_gone_heir.cov *= static_cast<double>(uses);
  map::Edge edge;
  edge.type = map::EdgeType::kCompounded;
  if (heir.weak || arm.weak) edge.type = map::EdgeType::kDeadReckoning;
  if (heir.guess || arm.guess) edge.type = map::EdgeType::kWeak;
  edge.a = heir.to;
  edge.b = arm.to;
  edge.T_a_b = types::compose(types::inverse(T_gone_heir), arm.T_gone_to);
  // A direction and a length, or two directions, make no direction.
  if (!edge.T_a_b.hasScale) edge.T_a_b.T_a_b.translation().setZero();
  return edge;
}

}  // namespace

Mending mend(const map::TopologicalMap& map, PlaceId gone, std::span<const PlaceId> mates) {
  std::set<PlaceId> others;
  for (const PlaceId mate : mates)
    if (mate != gone && map.places().contains(mate)) others.insert(mate);
  const std::vector<Arm> arms = armsOf(map, gone, others);
  if (arms.empty()) return {};
  const Arm& heir = arms.front();
  if (!heir.mate) others.clear();  // as good as a cluster of one

  Trunk trunk(map, others);
  trunk.grow(heir.to);
  std::vector<const Arm*> loose;
  for (std::size_t k = 1; k < arms.size(); ++k) {
    if (trunk.holds(arms[k])) continue;
    loose.push_back(&arms[k]);
    if (!arms[k].weak && arms[k].mate) trunk.grow(arms[k].to);
  }
  Mending mending{heir.to};
  for (const Arm* arm : loose) mending.bridges.push_back(bridge(heir, *arm, loose.size()));
  return mending;
}

}  // namespace engram::upkeep
