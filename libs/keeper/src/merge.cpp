// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/keeper/merge.h"

#include "combine.h"
#include "engram/base/error.h"
#include "engram/keeper/diff.h"
#include "engram/map/graph.h"
#include "engram/map/parts.h"
#include "engram/posegraph/robust.h"
#include "engram/store/map_file.h"
#include "joint.h"
#include "place_pairs.h"
#include "unify.h"

#include <algorithm>
#include <set>

namespace engram::keeper {
namespace {

constexpr std::size_t kLeastAgreeing = 3;  // places that must say the same of where a map lies
/// Share of the places of one map that lie beside places of the other which must be recognised. Simulated
/// offices of one plan with other rooms have 0.2, two robots months apart in one office 1.
constexpr double kLeastRecognised = 1.0 / 3;

bool joinsGround(const map::Edge& edge) {
  return edge.type == map::EdgeType::kLoop || edge.type == map::EdgeType::kRecognition;
}

bool allOf(const store::WholeMap& b, const CommonPast& past) {
  return !b.drives.empty() && past.drives.size() == b.drives.size();
}

/// Nothing is joined: why, and `a` stays.
Merged apart(Merged merged, const std::string& reason) {
  merged.reason = reason;
  return merged;
}

/// Where enough places agree on, or the reason why not.
std::string whyApart(std::size_t verified, std::size_t agreeing, std::size_t places, std::size_t beside) {
  const std::size_t least = std::min(kLeastAgreeing, places);
  if (verified == 0) return "no place of the second map is recognised in the first";
  if (agreeing < least)
    return "only " + std::to_string(agreeing) + " recognised places agree on where the second map lies; " +
           std::to_string(least) + " must";
  if (2 * agreeing <= verified)
    return "of " + std::to_string(verified) + " recognised places only " + std::to_string(agreeing) +
           " agree on where the second map lies: they may be two buildings that look alike";
  if (static_cast<double>(agreeing) < kLeastRecognised * static_cast<double>(beside))
    return "of " + std::to_string(beside) + " places that would lie beside places of the first map only " +
           std::to_string(agreeing) + " are recognised there: they may be two buildings of one plan";
  return "";
}

/// The graph of both maps, the closures of both and the joints, judged together.
class Judgement {
 public:
  Judgement(map::MapContent& content, const posegraph::RelaxerParams& params)
      : content_(content), params_(params) {
    for (const auto& [id, place] : content.places) trusted_.poses[id] = place.T_map_place;
    for (const auto& [id, edge] : content.edges) {
      if (joinsGround(edge)) {
        known_.push_back(id);
        closures_.push_back(map::toConstraint(edge));
      } else if (edge.type != map::EdgeType::kWeak) {
        trusted_.constraints.push_back(map::toConstraint(edge));
      }
    }
  }

  /// Puts those that are let in into the map, and the poses that follow. Returns the joints let in.
  std::vector<Joint> judge(const std::vector<Joint>& joints, bool joinedBefore) {
    for (const Joint& joint : joints) closures_.push_back({joint.a, joint.b, joint.T_a_b, true});
    std::vector<posegraph::ClosureDecision> previous(known_.size() +
                                                     (joinedBefore || joints.empty() ? 0 : 1));
    for (auto& decision : previous) decision = {true, posegraph::ClosureReason::kAgrees, 0, 0, 0};
    const auto judged = posegraph::relaxRobustly(params_, trusted_, closures_, previous);
    for (std::size_t i = 0; i < known_.size(); ++i)
      if (!judged.decisions[i].accepted) content_.edges.erase(known_[i]);
    std::vector<Joint> accepted;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (!judged.decisions[known_.size() + i].accepted) continue;
      accepted.push_back(joints[i]);
      add(joints[i]);
    }
    if (judged.relaxation.ending != posegraph::Ending::kFailed)
      for (const auto& [id, T] : judged.relaxation.poses) content_.places.at(id).T_map_place = T;
    for (auto& [id, place] : content_.places) place.joint = {};
    return accepted;
  }

 private:
  void add(const Joint& joint) {
    map::Edge edge{.id = map::EdgeId(content_.nextEdge++),
                   .type = map::EdgeType::kRecognition,
                   .a = joint.a,
                   .b = joint.b,
                   .T_a_b = joint.T_a_b};
    const memory::PlaceMemory& a = *content_.places.at(joint.a).memory;
    const memory::PlaceMemory& b = *content_.places.at(joint.b).memory;
    for (const types::Match& m : joint.matches)
      edge.correspondences.emplace_back(a.states[static_cast<std::size_t>(m.b)].id,
                                        b.states[static_cast<std::size_t>(m.a)].id);
    content_.edges.emplace(edge.id, std::move(edge));
  }

  map::MapContent& content_;
  posegraph::RelaxerParams params_;
  posegraph::Graph trusted_;
  std::vector<map::EdgeId> known_;
  std::vector<posegraph::Constraint> closures_;
};

/// The joints whose two places are one: near, and each the nearest to the other.
std::vector<Joint> onePlaces(std::vector<Joint> joints, const map::MapContent& content, double within) {
  const auto distance = [&](const Joint& j) {
    return (content.places.at(j.a).T_map_place.translation() -
            content.places.at(j.b).T_map_place.translation())
        .norm();
  };
  std::stable_sort(joints.begin(), joints.end(),
                   [&](const Joint& x, const Joint& y) { return distance(x) < distance(y); });
  std::set<map::PlaceId> taken;
  std::erase_if(joints, [&](const Joint& j) {
    if (distance(j) > within || taken.contains(j.a) || taken.contains(j.b)) return true;
    taken.insert({j.a, j.b});
    return false;
  });
  return joints;
}

/// Weak edges have served where something measured joins their ends now.
void dropServed(map::MapContent& content) {
  map::TopologicalMap map(std::move(content));
  map::Parts parts;
  map::dropJoinedWeakEdges(map, parts);
  content = map.content();
}

/// A map that went on from another one without its records: they come first.
store::WholeMap withOlderRecords(store::WholeMap map, const store::WholeMap& older) {
  if (map.firstRecord <= older.firstRecord) return map;
  const std::uint64_t missing = map.firstRecord - older.firstRecord;
  if (missing > older.records.size()) return map;
  map.records.insert(map.records.begin(), older.records.begin(),
                     older.records.begin() + static_cast<std::ptrdiff_t>(missing));
  map.firstRecord = older.firstRecord;
  return map;
}

/// A merge on its way: recognise, combine, judge, unite, relax.
class Merge {
 public:
  Merge(store::WholeMap& a, const store::WholeMap& b, const Configuration& configuration)
      : a_(a), b_(b), params_(configuration.params), pairs_(configuration), past_(commonPast(a, b)) {}

  const CommonPast& past() const { return past_; }

  Merged run(const std::function<void(double)>& progress) {
    Merged merged;
    merged.known = past_.places.size();
    std::vector<Joint> joints = agreed(merged, progress);
    if (!merged.reason.empty()) return merged;
    store::WholeMap both = a_;
    if (past_.places.empty()) merged.T_a_b = joints.front().T_maps;
    const Numbering numbers = combine(both, b_, past_, merged.T_a_b);
    for (Joint& joint : joints) joint.b = numbers.of(joint.b);
    joints = Judgement(both.content, params_.posegraph).judge(joints, !past_.places.empty());
    if (joints.empty() && past_.places.empty())
      return apart(merged, "the tests of closures deny every joint: odometry of the two maps contradicts it");
    dropServed(both.content);
    merged.closures = joints.size();
    if (params_.mapping.nodes != "views") merged.united = unite(both, joints);
    relaxAll(both.content, params_);
    both.header.firstStamp = std::min(a_.header.firstStamp, b_.header.firstStamp);
    merged.joined = true;
    a_ = std::move(both);
    return merged;
  }

 private:
  /// Joints of places that are not common to both.
  std::vector<Joint> agreed(Merged& merged, const std::function<void(double)>& progress) {
    map::MapContent others = b_.content;
    std::erase_if(others.places, [&](const auto& item) { return past_.places.contains(item.first); });
    std::vector<Joint> joints = recognised(a_.content, others, pairs_, progress);
    merged.verified = joints.size();
    joints = agreeing(std::move(joints), a_.content, pairs_);
    merged.agreeing = joints.size();
    if (!past_.places.empty()) return joints;
    const std::size_t beside =
        joints.empty() ? 0 : besidePlaces(joints, a_.content, b_.content, params_.place.spacing);
    merged.reason = whyApart(merged.verified, merged.agreeing, b_.content.places.size(), beside);
    return joints;
  }

  std::size_t unite(store::WholeMap& both, const std::vector<Joint>& joints) const {
    const auto ones = onePlaces(joints, both.content, 0.5 * params_.place.spacing);
    for (const Joint& joint : ones) unifyPlaces(both, joint, params_, pairs_.eye());
    return ones.size();
  }

  store::WholeMap& a_;
  const store::WholeMap& b_;
  const pipeline::PipelineParams& params_;
  PlacePairs pairs_;
  CommonPast past_;
};

}  // namespace

Merged merge(store::WholeMap& a, const store::WholeMap& b, const std::string& nameA, const std::string& nameB,
             const std::function<void(double)>& progress) {
  store::requireCompatible(a.header, b.header, nameA);
  const Configuration configuration = configurationOf(a.header, nameA);
  if (configuration.params.mapping.nodes == "scans")
    throw base::Error("maps of scans cannot be merged: a filter keeps the poses of '" + nameA + "' and '" +
                      nameB + "'");
  Merged nothing;
  nothing.joined = true;
  nothing.known = b.content.places.size();
  if (b.content.places.empty() || diff(a, b).same())
    return apart(nothing, "the second map holds nothing that the first does not");
  Merge work(a, b, configuration);
  if (allOf(b, work.past())) return apart(nothing, "all drives of the second map are in the first");
  if (allOf(a, commonPast(b, a)) || a.content.places.empty()) {
    a = withOlderRecords(b, a);
    return apart(nothing, "all drives of the first map are in the second");
  }
  return work.run(progress);
}

}  // namespace engram::keeper
