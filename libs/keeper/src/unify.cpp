// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "unify.h"

#include "engram/memory/unite.h"
#include "engram/pipeline/landmarks.h"
#include "engram/types/se3.h"

#include <algorithm>

namespace engram::keeper {
namespace {

/// What place b remembers, as place a would see it: features whose distance is known are moved exactly.
types::Features inFrameOf(const types::Features& a, const Joint& joint, const types::Features& b,
                          const Eigen::Vector3d& eye) {
  Eigen::Isometry3d T_a_b = joint.T_a_b.T_a_b;  // of the cameras
  T_a_b.translation() += T_a_b.linear() * eye - eye;
  types::Features moved = pipeline::inPlaceFrame(b, T_a_b, a, joint.matches);
  for (std::size_t i = 0; i < moved.ranges.size(); ++i) {
    if (!(moved.ranges[i] > 0) || i >= b.bearings.size()) continue;
    const Eigen::Vector3d point = T_a_b * Eigen::Vector3d(b.bearings[i].cast<double>() * b.ranges[i]);
    moved.ranges[i] = static_cast<float>(point.norm());
    if (point.norm() > 0) moved.bearings[i] = point.normalized().cast<float>();
  }
  return moved;
}

memory::United unitedOf(const map::Place& a, const map::Place& b, const Joint& joint,
                        const pipeline::PipelineParams& params, const Eigen::Vector3d& eye) {
  memory::PlaceMemory theirs = b.memory;
  theirs.features = inFrameOf(a.memory->features, joint, b.memory->features, eye);
  const bool ordered = a.createdStamp <= b.createdStamp;
  const std::string& model = params.memory.memory;
  const bool oneStays = model == "static" || model == "replace";
  if (!oneStays || ordered)
    return memory::unite(a.memory, theirs, joint.matches, params.memory, params.fsh, params.multi_store);
  // b is the older one: roles are the other way round.
  std::vector<types::Match> back = joint.matches;
  for (types::Match& m : back) std::swap(m.a, m.b);
  memory::United u = memory::unite(theirs, a.memory, back, params.memory, params.fsh, params.multi_store);
  std::swap(u.idOfA, u.idOfB);
  return u;
}

using Renumbered = std::map<std::uint32_t, std::uint32_t>;

/// The end of an edge is at another place, or its features have other numbers.
void renumber(map::Edge& edge, map::PlaceId end, const Renumbered& ids) {
  const bool isA = edge.a == end;
  std::erase_if(edge.correspondences,
                [&](const auto& pair) { return !ids.contains(isA ? pair.first : pair.second); });
  for (auto& pair : edge.correspondences)
    (isA ? pair.first : pair.second) = ids.at(isA ? pair.first : pair.second);
}

void moveEnd(map::Edge& edge, const Joint& joint) {
  if (edge.a == joint.b) {
    edge.a = joint.a;
    edge.T_a_b = types::compose(joint.T_a_b, edge.T_a_b);
  } else {
    edge.b = joint.a;
    edge.T_a_b = types::compose(edge.T_a_b, types::inverse(joint.T_a_b));
  }
}

void moveEdges(map::MapContent& content, const Joint& joint, const memory::United& united) {
  std::erase_if(content.edges, [&](const auto& item) {
    return std::minmax(item.second.a, item.second.b) == std::minmax(joint.a, joint.b);
  });
  for (auto& [id, edge] : content.edges) {
    if (edge.a == joint.a || edge.b == joint.a) renumber(edge, joint.a, united.idOfA);
    if (edge.a != joint.b && edge.b != joint.b) continue;
    renumber(edge, joint.b, united.idOfB);
    moveEnd(edge, joint);
  }
}

void replaceIn(std::vector<types::FrameReport>& records, const Joint& joint) {
  const map::PlaceId gone = joint.b, by = joint.a;
  const auto change = [&](base::PlaceId& id) {
    if (id == gone) id = by;
  };
  for (types::FrameReport& report : records) {
    change(report.place);
    change(report.bestGuess);
    for (auto& hypothesis : report.hypotheses) change(hypothesis.place);
    for (auto& id : report.learnt) change(id);
    if (!report.pose || report.pose->place != gone) continue;
    report.pose->place = by;
    report.pose->T_place_robot = types::compose(joint.T_a_b, report.pose->T_place_robot);
  }
}

}  // namespace

void unifyPlaces(store::WholeMap& whole, const Joint& joint, const pipeline::PipelineParams& params,
                 const Eigen::Vector3d& eye) {
  map::MapContent& map = whole.content;
  map::Place& a = map.places.at(joint.a);
  const map::Place b = map.places.at(joint.b);
  memory::United united = unitedOf(a, b, joint, params, eye);
  a.memory = std::move(united.memory);
  if (b.matchedStamp) a.matchedStamp = std::max(a.matchedStamp.value_or(*b.matchedStamp), *b.matchedStamp);
  if (b.standing == map::Standing::kConfirmed) a.standing = b.standing;
  moveEdges(map, joint, united);
  for (auto& [id, view] : map.views)
    if (view.place == joint.b) view.place = joint.a;
  const Eigen::Isometry3d T_a_b = a.T_map_place.inverse() * b.T_map_place;
  for (map::PathPoint& point : map.path) {
    if (point.anchor != joint.b) continue;
    point.anchor = joint.a;
    point.T_anchor_robot = types::rigid(T_a_b * point.T_anchor_robot);
  }
  replaceIn(whole.records, joint);
  map.places.erase(joint.b);
}

}  // namespace engram::keeper
