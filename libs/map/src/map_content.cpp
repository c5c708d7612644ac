// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/map/map_content.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <span>

namespace engram::map {
namespace {

constexpr double kFarthest = 1e9;  // [m]; squares of what is farther leave no digits for a map
// [m², rad²]: what is beyond is no measurement, and its inverse or square would overflow.
constexpr double kLargestVariance = 1e24, kSmallestVariance = 1e-40;
constexpr int kMostSessions = 1 << 24;

bool isRigid(const Eigen::Isometry3d& T) {
  const Eigen::Matrix3d R = T.linear();
  return T.matrix().allFinite() &&
         (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-6 &&
         R.determinant() > 0;
}

/// Of a pose, in words; empty when all is well.
std::string brokenRule(const Eigen::Isometry3d& T, const char* what) {
  if (!isRigid(T)) return std::string(what) + " is not a finite rigid transform";
  if (T.translation().cwiseAbs().maxCoeff() > kFarthest)
    return std::string(what) + " is more than 1e9 m away";
  return {};
}

/// When and in which drive something was made.
std::string brokenRule(double stamp, int session) {
  if (!std::isfinite(stamp)) return "its time stamp is not finite";
  if (session < 0 || session >= kMostSessions) return "its number of the drive is out of range";
  return {};
}

bool isPositiveDefinite(const Eigen::Ref<const Eigen::MatrixXd>& m) {
  const Eigen::LLT<Eigen::MatrixXd> factors(m);
  return factors.info() == Eigen::Success &&
         factors.matrixLLT().diagonal().minCoeff() >= std::sqrt(kSmallestVariance);
}

bool allFinite(std::span<const float> values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

std::string brokenRule(const types::Features& f) {
  const auto finite = [](const types::Keypoint& k) {
    return allFinite(std::array{k.x, k.y, k.size, k.angle, k.response});
  };
  if (!std::all_of(f.keypoints.begin(), f.keypoints.end(), finite)) return "a keypoint is not finite";
  if (f.descriptors.kind() == types::DescriptorKind::kFloat)
    for (std::size_t i = 0; i < f.descriptors.size(); ++i)
      if (!allFinite({f.descriptors.floats(i), static_cast<std::size_t>(f.descriptors.dim())}))
        return "a descriptor is not finite";
  for (const Eigen::Vector3f& bearing : f.bearings)
    if (!allFinite({bearing.data(), 3})) return "a bearing is not finite";
  for (const float range : f.ranges)
    if (!(range >= 0) || !std::isfinite(range)) return "a range is negative or not finite";
  return {};
}

/// None of a place whose memory was not read.
std::optional<std::set<std::uint32_t>> featureIds(const Place& place) {
  if (!place.memory.isHere()) return std::nullopt;
  std::set<std::uint32_t> ids;
  for (const auto& state : place.memory->states) ids.insert(state.id);
  return ids;
}

std::string name(const char* kind, std::uint32_t id) { return std::string(kind) + " " + std::to_string(id); }

void checkEdges(const MapContent& content, std::vector<std::string>& broken) {
  std::map<PlaceId, std::optional<std::set<std::uint32_t>>> known;
  const auto knows = [](const auto& ids, std::uint32_t id) { return !ids || ids->contains(id); };
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
      if (!knows(a->second, featureA) || !knows(b->second, featureB)) {
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

std::string brokenRule(const MapHeader& header) {
  if (header.descriptorKind > types::DescriptorKind::kBinary) return "its descriptors are of an unknown kind";
  if (header.descriptorDim < 1 || header.descriptorDim > kMostDescriptorDim)
    return "the dimension of its descriptors is out of range";
  return std::isfinite(header.firstStamp) ? "" : "its first time stamp is not finite";
}

namespace {

std::string brokenRule(const JointErrors& joint, PlaceId own) {
  const auto rows = joint.cov.rows(), count = static_cast<Eigen::Index>(joint.with.size());
  if (joint.empty() && joint.cov.size() == 0) return {};
  if (joint.empty() || (rows != 3 && rows != 6) || joint.cov.cols() != rows * count)
    return "its covariance is not that of the places it names";
  if (joint.with.back() != own || !std::is_sorted(joint.with.begin(), joint.with.end()))
    return "its covariance is not with earlier places";
  if (!joint.cov.allFinite() || joint.cov.cwiseAbs().maxCoeff() > kLargestVariance)
    return "its covariance is too large to mean anything";
  return joint.own().diagonal().minCoeff() > 0 ? "" : "its covariance is not positive definite";
}

}  // namespace

std::string brokenRule(const memory::PlaceMemory& memory) {
  const std::size_t n = memory.states.size();
  const auto& f = memory.features;
  if (f.keypoints.size() != n || f.descriptors.size() != n ||
      (!f.bearings.empty() && f.bearings.size() != n) || (!f.ranges.empty() && f.ranges.size() != n))
    return "its features, descriptors, bearings, ranges and states differ in number";
  if (const std::string rule = brokenRule(f); !rule.empty()) return rule;
  std::vector<std::uint32_t> ids;
  ids.reserve(n);
  for (const auto& state : memory.states) {
    if (!std::isfinite(state.value)) return "the value of a feature is not finite";
    ids.push_back(state.id);
  }
  std::sort(ids.begin(), ids.end());
  if (std::adjacent_find(ids.begin(), ids.end()) != ids.end()) return "two of its features have the same id";
  if (!ids.empty() && ids.back() >= memory.nextFeatureId)
    return "a feature id is not below the next free one";
  if (memory.nextFeatureId > kMostIds) return "it has used up its numbers of features";
  return {};
}

std::string brokenRule(const MapHeader& header, const memory::PlaceMemory& memory) {
  const types::Descriptors& d = memory.features.descriptors;
  const bool fits = d.empty() || (d.kind() == header.descriptorKind && d.dim() == header.descriptorDim);
  return fits ? "" : "its descriptors are not those that the header names";
}

std::string brokenRule(const Place& place) {
  std::string rule = brokenRule(place.T_map_place, "its pose");
  if (rule.empty() && place.T_world_place) rule = brokenRule(*place.T_world_place, "its surveyed pose");
  if (rule.empty()) rule = brokenRule(place.createdStamp, place.session);
  if (rule.empty() && place.matchedStamp && !std::isfinite(*place.matchedStamp))
    rule = "the time of its last match is not finite";
  if (rule.empty()) rule = brokenRule(place.joint, place.id);
  return rule.empty() && place.memory.isHere() ? brokenRule(*place.memory) : rule;
}

std::string brokenRule(const View& view) { return brokenRule(view.stamp, view.session); }

std::string brokenRule(const PathPoint& point) {
  const std::string rule = brokenRule(point.T_anchor_robot, "its pose");
  return rule.empty() ? brokenRule(point.stamp, point.session) : rule;
}

std::string brokenRule(const Edge& edge) {
  if (edge.a == edge.b) return "it joins a place with itself";
  const auto& [T_a_b, cov, hasScale] = edge.T_a_b;
  if (const std::string rule = brokenRule(T_a_b, "its pose"); !rule.empty()) return rule;
  if (!cov.allFinite()) return "its covariance is not finite";
  if (cov.cwiseAbs().maxCoeff() > kLargestVariance) return "its covariance is too large to mean anything";
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
  for (const std::uint32_t next : {content.nextPlace, content.nextView, content.nextEdge})
    if (next > kMostIds) broken.push_back("the map has used up its numbers");
  for (const auto& [id, place] : content.places) {
    const std::string what = name("place", id.value);
    if (id != place.id || id.value >= content.nextPlace) broken.push_back(what + " has a wrong id");
    if (const std::string rule = brokenRule(place); !rule.empty()) broken.push_back(what + ": " + rule);
  }
  for (const auto& [id, view] : content.views) {
    const std::string what = name("view", id.value);
    if (id != view.id || id.value >= content.nextView) broken.push_back(what + " has a wrong id");
    if (const std::string rule = brokenRule(view); !rule.empty()) broken.push_back(what + ": " + rule);
    if (!content.places.contains(view.place)) broken.push_back(what + " is of a place that does not exist");
  }
  checkEdges(content, broken);
  for (std::size_t i = 0; i < content.path.size(); ++i) {
    const PathPoint& point = content.path[i];
    const std::string what = "path point " + std::to_string(i);
    if (!content.places.contains(point.anchor))
      broken.push_back(what + " is tied to a place that does not exist");
    if (const std::string rule = brokenRule(point); !rule.empty()) broken.push_back(what + ": " + rule);
  }
  return broken;
}

std::vector<std::string> brokenRules(const MapHeader& header, const MapContent& content) {
  std::vector<std::string> broken;
  for (const auto& [id, place] : content.places) {
    if (!place.memory.isHere()) continue;
    if (const std::string rule = brokenRule(header, *place.memory); !rule.empty())
      broken.push_back(name("place", id.value) + ": " + rule);
  }
  return broken;
}

}  // namespace engram::map
