// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/map/map_content.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <set>

namespace engram::map {
namespace {

bool isRigid(const Eigen::Isometry3d& T) {
  const Eigen::Matrix3d R = T.linear();
  return T.matrix().allFinite() &&
         (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-6 &&
         R.determinant() > 0;
}

bool isPositiveDefinite(const Eigen::Ref<const Eigen::MatrixXd>& m) {
  return Eigen::LLT<Eigen::MatrixXd>(m).info() == Eigen::Success;
}

std::string brokenRule(const memory::PlaceMemory& memory) {
  const std::size_t n = memory.states.size();
  const auto& f = memory.features;
  if (f.keypoints.size() != n || f.descriptors.size() != n ||
      (!f.bearings.empty() && f.bearings.size() != n) || (!f.ranges.empty() && f.ranges.size() != n))
    return "its features, descriptors, bearings, ranges and states differ in number";
  std::vector<std::uint32_t> ids;
  ids.reserve(n);
  for (const auto& state : memory.states) ids.push_back(state.id);
  std::sort(ids.begin(), ids.end());
  if (std::adjacent_find(ids.begin(), ids.end()) != ids.end()) return "two of its features have the same id";
  if (!ids.empty() && ids.back() >= memory.nextFeatureId)
    return "a feature id is not below the next free one";
  return {};
}

std::set<std::uint32_t> featureIds(const Place& place) {
  std::set<std::uint32_t> ids;
  for (const auto& state : place.memory.states) ids.insert(state.id);
  return ids;
}

std::string name(const char* kind, std::uint32_t id) { return std::string(kind) + " " + std::to_string(id); }

void checkEdges(const MapContent& content, std::vector<std::string>& broken) {
  std::map<PlaceId, std::set<std::uint32_t>> known;
  for (const auto& [id, place] : content.places) known[id] = featureIds(place);
  for (const auto& [id, edge] : content.edges) {
    const std::string what = name("edge", id.value);
    if (id != edge.id || id.value >= content.nextEdge) broken.push_back(what + " has a wrong id");
    if (const std::string rule = brokenRule(edge); !rule.empty()) broken.push_back(what + ": " + rule);
    const auto a = known.find(edge.a), b = known.find(edge.b);
    if (a == known.end() || b == known.end()) {
      broken.push_back(what + " ends at a place that does not exist");
      continue;
    }
    for (const auto& [featureA, featureB] : edge.correspondences)
      if (!a->second.contains(featureA) || !b->second.contains(featureB)) {
        broken.push_back(what + " names a feature that its place does not remember");
        break;
      }
  }
}

}  // namespace

const char* toString(EdgeType type) {
  switch (type) {
    case EdgeType::kOdometry:
      return "odometry";
    case EdgeType::kLoop:
      return "loop";
    case EdgeType::kRecognition:
      return "recognition";
    case EdgeType::kWeak:
      return "weak";
    case EdgeType::kCompounded:
      return "compounded";
    case EdgeType::kDeadReckoning:
      return "dead reckoning";
  }
  return "?";
}

bool isPassage(EdgeType type) { return type != EdgeType::kWeak && type != EdgeType::kDeadReckoning; }

const char* toString(Standing standing) {
  switch (standing) {
    case Standing::kConfirmed:
      return "confirmed";
    case Standing::kUnmatched:
      return "unmatched";
    case Standing::kProbation:
      return "probation";
  }
  return "?";
}

std::string brokenRule(const Place& place) {
  if (!isRigid(place.T_map_place)) return "its pose is not a finite rigid transform";
  if (place.T_world_place && !isRigid(*place.T_world_place))
    return "its surveyed pose is not a finite rigid transform";
  if (place.matchedStamp && !std::isfinite(*place.matchedStamp))
    return "the time of its last match is not finite";
  return brokenRule(place.memory);
}

std::string brokenRule(const Edge& edge) {
  if (edge.a == edge.b) return "it joins a place with itself";
  const auto& [T_a_b, cov, hasScale] = edge.T_a_b;
  if (!isRigid(T_a_b)) return "its pose is not a finite rigid transform";
  if (!cov.allFinite()) return "its covariance is not finite";
  if ((cov - cov.transpose()).cwiseAbs().maxCoeff() > 1e-9 * cov.cwiseAbs().maxCoeff())
    return "its covariance is not symmetric";
  // Without scale nothing is known along the translation, so only the rotation must be known.
  if (hasScale ? !isPositiveDefinite(cov) : !isPositiveDefinite(cov.bottomRightCorner<3, 3>()))
    return "its covariance is not positive definite";
  return {};
}

std::vector<std::string> brokenRules(const MapContent& content) {
  std::vector<std::string> broken;
  if (const std::string rule = memory::brokenRule(content.redetections); !rule.empty())
    broken.push_back(rule);
  for (const auto& [id, place] : content.places) {
    const std::string what = name("place", id.value);
    if (id != place.id || id.value >= content.nextPlace) broken.push_back(what + " has a wrong id");
    if (const std::string rule = brokenRule(place); !rule.empty()) broken.push_back(what + ": " + rule);
  }
  for (const auto& [id, view] : content.views) {
    const std::string what = name("view", id.value);
    if (id != view.id || id.value >= content.nextView) broken.push_back(what + " has a wrong id");
    if (!content.places.contains(view.place)) broken.push_back(what + " is of a place that does not exist");
  }
  checkEdges(content, broken);
  for (std::size_t i = 0; i < content.path.size(); ++i) {
    const PathPoint& point = content.path[i];
    const std::string what = "path point " + std::to_string(i);
    if (!content.places.contains(point.anchor))
      broken.push_back(what + " is tied to a place that does not exist");
    if (!isRigid(point.T_anchor_robot)) broken.push_back(what + ": its pose is not a finite rigid transform");
  }
  return broken;
}

}  // namespace engram::map
