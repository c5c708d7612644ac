// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/map/topological_map.h"

#include "engram/base/error.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>
#include <tuple>

namespace engram::map {
namespace {

using Kind = Journal::Kind;

/// The next free number; throws when a map, which never uses one again, has none left.
std::uint32_t take(std::uint32_t& next) {
  if (next >= kMostIds) throw base::Error("the map has used up its numbers: start a new one");
  return next++;
}

std::string ends(const Edge& edge) {
  return "edge from place " + std::to_string(edge.a.value) + " to place " + std::to_string(edge.b.value);
}

}  // namespace

TopologicalMap::TopologicalMap(MapContent content) : content_(std::move(content)) {
  checkInvariants();
  for (const auto& [id, place] : content_.places) holds_[id];
  for (const auto& [id, view] : content_.views) holds_[view.place].views.push_back(id);
  for (const auto& [id, edge] : content_.edges) {
    holds_[edge.a].edges.push_back(id);
    holds_[edge.b].edges.push_back(id);
  }
  for (std::size_t i = 0; i < content_.path.size(); ++i) holds_[content_.path[i].anchor].path.push_back(i);
  taken_ = now();
}

PlaceId TopologicalMap::addPlace(Place place) {
  place.joint = {};
  if (const std::string rule = brokenRule(place); !rule.empty())
    throw base::Error("cannot add the place made from image '" + place.createdLabel + "': " + rule);
  place.id = PlaceId(take(content_.nextPlace));
  const PlaceId id = place.id;
  content_.places.emplace(id, std::move(place));
  holds_[id];
  journal_.note(Kind::kPlace, id.value);
  journal_.note(Kind::kMemory, id.value);
  return id;
}

ViewId TopologicalMap::addView(View view) {
  place(view.place);  // throws when unknown
  if (const std::string rule = brokenRule(view); !rule.empty())
    throw base::Error("cannot add the view '" + view.label + "': " + rule);
  view.id = ViewId(take(content_.nextView));
  const ViewId id = view.id;
  holds_[view.place].views.push_back(id);
  content_.views.emplace(id, std::move(view));
  journal_.note(Kind::kView, id.value);
  return id;
}

EdgeId TopologicalMap::addEdge(Edge edge) {
  if (!content_.places.contains(edge.a) || !content_.places.contains(edge.b))
    throw base::Error(ends(edge) + ": no such place in the map");
  if (const std::string rule = brokenRule(edge); !rule.empty()) throw base::Error(ends(edge) + ": " + rule);
  edge.id = EdgeId(take(content_.nextEdge));
  const EdgeId id = edge.id;
  const PlaceId a = edge.a, b = edge.b;
  content_.edges.emplace(id, std::move(edge));
  holds_[a].edges.push_back(id);
  holds_[b].edges.push_back(id);
  journal_.note(Kind::kEdge, id.value);
  if (!content_.edges.at(id).correspondences.empty()) {
    dropForgotten(a);
    dropForgotten(b);
  }
  return id;
}

void TopologicalMap::removeEdge(EdgeId id) {
  const Edge& gone = edge(id);
  std::erase(holds_[gone.a].edges, id);
  std::erase(holds_[gone.b].edges, id);
  content_.edges.erase(id);
  journal_.drop(Kind::kEdge, id.value);
  journal_.note(Kind::kRemovedEdge, id.value);
}

void TopologicalMap::stretchEdge(EdgeId id, double factor) {
  if (!(factor > 0) || !std::isfinite(factor))
    throw base::Error(ends(edge(id)) + ": it cannot become " + std::to_string(factor) + " times as long");
  content_.edges.at(id).T_a_b.T_a_b.translation() *= factor;
  journal_.note(Kind::kEdge, id.value);
}

void TopologicalMap::addPathPoint(const PathPoint& point) {
  place(point.anchor);  // throws when unknown
  if (const std::string rule = brokenRule(point); !rule.empty())
    throw base::Error("the path cannot take a point: " + rule);
  holds_[point.anchor].path.push_back(content_.path.size());
  content_.path.push_back(point);
}

void TopologicalMap::forgetPath(int firstKeptSession) {
  const auto gone =
      std::erase_if(content_.path, [&](const PathPoint& p) { return p.session < firstKeptSession; });
  if (gone == 0) return;
  for (auto& [id, holds] : holds_) holds.path.clear();
  for (std::size_t i = 0; i < content_.path.size(); ++i) holds_[content_.path[i].anchor].path.push_back(i);
  journal_.note(Kind::kForgottenPath);
}

void TopologicalMap::removePlace(PlaceId id, PlaceId heir) {
  if (id == heir) throw base::Error("place " + std::to_string(id.value) + " cannot be its own heir");
  const Eigen::Isometry3d T_heir_gone = place(heir).T_map_place.inverse() * place(id).T_map_place;
  const Holds holds = holds_.at(id);  // a copy: removeEdge() edits it
  for (const EdgeId edge : holds.edges) removeEdge(edge);
  for (const ViewId view : holds.views) {
    content_.views.erase(view);
    journal_.drop(Kind::kView, view.value);
    journal_.note(Kind::kRemovedView, view.value);
  }
  auto& inherited = holds_.at(heir).path;
  for (const std::size_t i : holds.path) {
    PathPoint& point = content_.path[i];
    point = {point.session, point.stamp, heir, T_heir_gone * point.T_anchor_robot};
    inherited.insert(std::lower_bound(inherited.begin(), inherited.end(), i), i);
    journal_.note(Kind::kMovedPathPoint, i);
  }
  content_.places.erase(id);
  holds_.erase(id);
  for (const Kind kind : {Kind::kPlace, Kind::kMemory}) journal_.drop(kind, id.value);
  journal_.note(Kind::kRemovedPlace, id.value);
}

void TopologicalMap::setPose(PlaceId id, const Eigen::Isometry3d& T_map_place) {
  setPoses({{id, T_map_place}});
}

void TopologicalMap::setPoses(const std::map<PlaceId, Eigen::Isometry3d>& T_map_place) {
  for (const auto& [id, T] : T_map_place) {
    Place moved;
    moved.T_map_place = T;
    if (const std::string rule = brokenRule(moved); !rule.empty())
      throw base::Error("cannot move place " + std::to_string(id.value) + ": " + rule);
    place(id);  // throws when unknown, before anything has changed
  }
  for (const auto& [id, T] : T_map_place) {
    Place& target = mutablePlace(id);
    if (target.T_map_place.matrix() == T.matrix()) continue;
    target.T_map_place = T;
    target.joint = {};
    journal_.note(Kind::kPlace, id.value);
  }
}

void TopologicalMap::setJointErrors(const std::map<PlaceId, JointErrors>& joint) {
  for (const auto& [id, errors] : joint) {
    Place uncertain;
    uncertain.id = place(id).id;  // throws when unknown, before anything has changed
    uncertain.joint = errors;
    if (const std::string rule = brokenRule(uncertain); !rule.empty())
      throw base::Error("cannot keep how place " + std::to_string(id.value) + " errs: " + rule);
  }
  for (const auto& [id, errors] : joint) {
    mutablePlace(id).joint = errors;
    journal_.note(Kind::kPlace, id.value);
  }
}

void TopologicalMap::setStanding(PlaceId id, Standing standing, std::optional<double> matchedStamp) {
  Place judged;
  judged.matchedStamp = matchedStamp;
  if (const std::string rule = brokenRule(judged); !rule.empty())
    throw base::Error("cannot judge place " + std::to_string(id.value) + ": " + rule);
  Place& target = mutablePlace(id);
  if (target.standing == standing && target.matchedStamp == matchedStamp) return;
  target.standing = standing;
  target.matchedStamp = matchedStamp;
  journal_.note(Kind::kPlace, id.value);
}

void TopologicalMap::survey(PlaceId id, const Eigen::Isometry3d& T_world_place) {
  Place surveyed;
  surveyed.T_map_place = T_world_place;
  if (const std::string rule = brokenRule(surveyed); !rule.empty())
    throw base::Error("cannot survey place " + std::to_string(id.value) + ": " + rule);
  mutablePlace(id).T_world_place = T_world_place;
  journal_.note(Kind::kPlace, id.value);
}

types::MemoryChange TopologicalMap::remember(PlaceId id, const memory::MemoryModel& model,
                                             const types::Features& view,
                                             std::span<const types::Match> matches) {
  Place& target = mutablePlace(id);
  const types::MemoryChange change = model.learn(target.memory.edit(), view, matches, content_.redetections);
  journal_.note(Kind::kMemory, id.value);
  dropForgotten(id);
  return change;
}

void TopologicalMap::measure(PlaceId id, std::span<const std::pair<int, float>> ranges) {
  types::Features& features = mutablePlace(id).memory.edit().features;
  for (const auto& [i, range] : ranges)
    if (i < 0 || static_cast<std::size_t>(i) >= features.size() || !(range > 0) || !std::isfinite(range))
      throw base::Error("a range of place " + std::to_string(id.value) + " is of no feature or no distance");
  bool changed = false;
  for (const auto& [i, range] : ranges) {
    features.ranges.resize(features.size());
    float& known = features.ranges[static_cast<std::size_t>(i)];
    if (known > 0) continue;
    known = range;
    changed = true;
  }
  if (changed) journal_.note(Kind::kMemory, id.value);
}

void TopologicalMap::dropForgotten(PlaceId id) {
  const auto& edges = holds_.at(id).edges;
  if (edges.empty()) return;
  std::set<std::uint32_t> known;
  for (const auto& state : content_.places.at(id).memory->states) known.insert(state.id);
  for (const EdgeId edgeId : edges) {
    Edge& edge = content_.edges.at(edgeId);
    const bool isA = edge.a == id;
    const auto gone = std::erase_if(edge.correspondences, [&](const auto& pair) {
      return !known.contains(isA ? pair.first : pair.second);
    });
    if (gone > 0) journal_.note(Kind::kEdge, edgeId.value);
  }
}

Place& TopologicalMap::mutablePlace(PlaceId id) { return const_cast<Place&>(place(id)); }

const Place& TopologicalMap::place(PlaceId id) const {
  const auto it = content_.places.find(id);
  if (it == content_.places.end()) throw base::Error("the map has no place " + std::to_string(id.value));
  return it->second;
}

const Edge& TopologicalMap::edge(EdgeId id) const {
  const auto it = content_.edges.find(id);
  if (it == content_.edges.end()) throw base::Error("the map has no edge " + std::to_string(id.value));
  return it->second;
}

Eigen::Isometry3d TopologicalMap::T_map_robot(const PathPoint& point) const {
  return place(point.anchor).T_map_place * point.T_anchor_robot;
}

int TopologicalMap::nextSession() const {
  int last = -1;
  for (const auto& [id, place] : content_.places) last = std::max(last, place.session);
  for (const auto& [id, view] : content_.views) last = std::max(last, view.session);
  for (const auto& point : content_.path) last = std::max(last, point.session);
  return last + 1;
}

const std::vector<ViewId>& TopologicalMap::viewsOf(PlaceId id) const {
  place(id);  // throws when unknown
  return holds_.at(id).views;
}

std::vector<Neighbour> TopologicalMap::neighbours(PlaceId id) const {
  place(id);  // throws when unknown
  std::vector<Neighbour> out;
  for (const EdgeId edgeId : holds_.at(id).edges) {
    const Edge& e = content_.edges.at(edgeId);
    out.push_back({e.a == id ? e.b : e.a, edgeId, e.type});
  }
  return out;
}

std::map<PlaceId, int> TopologicalMap::hopDistances(PlaceId from, int maxHops, bool throughAll) const {
  std::map<PlaceId, int> hops{{place(from).id, 0}};
  std::deque<PlaceId> queue{from};
  for (; !queue.empty(); queue.pop_front()) {
    const int next = hops.at(queue.front()) + 1;
    if (next > maxHops) break;
    for (const Neighbour& n : neighbours(queue.front()))
      if ((throughAll || isPassage(n.type)) && hops.emplace(n.place, next).second) queue.push_back(n.place);
  }
  return hops;
}

std::vector<std::vector<PlaceId>> TopologicalMap::components() const {
  std::vector<std::vector<PlaceId>> groups;
  std::set<PlaceId> seen;
  for (const auto& [id, unused] : content_.places) {
    if (seen.contains(id)) continue;
    auto& group = groups.emplace_back();
    for (const auto& [member, hops] : hopDistances(id, static_cast<int>(content_.places.size()), true)) {
      group.push_back(member);
      seen.insert(member);
    }
  }
  return groups;
}

void TopologicalMap::checkInvariants() const {
  const auto broken = brokenRules(content_);
  if (!broken.empty()) throw base::Error("the map is not consistent: " + broken.front());
}

MapChanges TopologicalMap::changesSince(Cursor& cursor) const {
  MapChanges changes = journal_.since(cursor.sequence);
  changes.firstNewPathPoint = changes.pathForgotten ? 0 : std::min(cursor.pathSize, content_.path.size());
  changes.pathSize = content_.path.size();
  std::erase_if(changes.movedPathPoints, [&](std::size_t i) { return i >= changes.firstNewPathPoint; });
  cursor = now();
  return changes;
}

}  // namespace engram::map
