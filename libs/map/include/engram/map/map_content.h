// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/ids.h"
#include "engram/map/derived.h"
#include "engram/map/on_demand.h"
#include "engram/memory/place_memory.h"
#include "engram/memory/redetections.h"
#include "engram/types/features.h"
#include "engram/types/rel_pose.h"

#include <Eigen/Geometry>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace engram::map {

using base::EdgeId;
using base::PlaceId;
using base::ViewId;

/// Numbers of places, views, edges, features, path points and records are below this.
inline constexpr std::uint32_t kMostIds = 0xff000000;
/// Components or bits of a descriptor.
inline constexpr int kMostDescriptorDim = 65536;

/// What a map was made with. A program whose own values differ must not use the map.
struct MapHeader {
  std::string engramVersion;
  std::string camera;     ///< Camera::toText()
  std::string extractor;  ///< `surf`, `akaze`, …
  types::DescriptorKind descriptorKind = types::DescriptorKind::kInt8;
  int descriptorDim = 0;    ///< components or bits
  std::string memoryModel;  ///< `fsh`, `static`, …
  std::string parameters;   ///< Config::dump() of the program that made the map
  double firstStamp = 0;  ///< [s] stamp of the first image; no wall clock, so that equal runs give equal maps
  bool operator==(const MapHeader&) const = default;
};

/// What the rules of forgetting know of a place (K-28 with K-E8).
enum class Standing : std::uint8_t {
  kConfirmed,  ///< it has matched another view, or no rule has looked at it yet
  kUnmatched,  ///< it matched no view when it was made: counts as older than all confirmed ones
  kProbation,  ///< the same where there was no room: it goes unless the next view in its neighbourhood
               ///< matches it
};

const char* toString(Standing standing);

/// How a pose errs together with those of earlier places: errors of the map frame, see
/// posegraph::ScanFilter. The covariance has 3 rows (x, y, yaw) or 6, and as many columns for each of `with`.
struct JointErrors {
  std::vector<PlaceId> with;  ///< rising, last the place itself; may name places that are gone
  Eigen::MatrixXd cov;        ///< [m] and [rad]
  bool empty() const { return with.empty(); }
  /// Of the place alone.
  Eigen::MatrixXd own() const { return cov.rightCols(cov.rows()); }
};

/// A place of the topological map: one node.
struct Place {
  PlaceId id;
  Eigen::Isometry3d T_map_place = Eigen::Isometry3d::Identity();  ///< pose of the robot at the reference view
  OnDemand<memory::PlaceMemory> memory;
  double createdStamp = 0;         ///< [s]
  std::uint64_t createdIndex = 0;  ///< Frame::index
  std::string createdLabel;
  int session = 0;  ///< drive in which it was made, from 0
  Standing standing = Standing::kConfirmed;
  std::optional<double> matchedStamp;  ///< [s] of the last view that matched it, if that is kept (K-E9)
  JointErrors joint;  ///< of the pose, where a filter keeps it; empty once the pose is moved otherwise
  std::optional<Eigen::Isometry3d>
      T_world_place;  ///< surveyed pose, for evaluation only: no step may read it
};

/// An image that was taken at a place.
struct View {
  ViewId id{};
  PlaceId place{};
  double stamp = 0;              ///< [s]
  std::uint64_t frameIndex = 0;  ///< Frame::index
  std::string label{};
  int session = 0;
  std::vector<std::uint8_t> jpeg{};  ///< thumbnail; empty when none is kept
};

enum class EdgeType : std::uint8_t {
  kOdometry,     ///< between places met one after the other
  kLoop,         ///< verified closure within a session
  kRecognition,  ///< verified match between sessions
  kWeak,  ///< joins a disjoint sequence; its pose is a guess and no metric search goes through it (K-11,
          ///< K-E14)
  kCompounded,     ///< replaces a chain of removed places (K-12)
  kDeadReckoning,  ///< odometry over ground that the robot knew: metric, but its ends are no neighbours
};

/// Whether a robot at one end may be at the other next: the hops of the map are along these.
bool isPassage(EdgeType type);
const char* toString(EdgeType type);

/// A relative pose between two places, with the features that it was found by.
struct Edge {
  EdgeId id{};
  EdgeType type = EdgeType::kOdometry;
  PlaceId a{}, b{};
  types::RelPose T_a_b{};  ///< pose of b seen from a, with covariance (K-E1)
  /// Corresponding features (F-05): FeatureState::id at a, at b.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> correspondences{};
};

/// One keyframe of the robot's path, tied to a place so that the path bends with the map.
struct PathPoint {
  int session = 0;
  double stamp = 0;  ///< [s]
  PlaceId anchor{};
  Eigen::Isometry3d T_anchor_robot = Eigen::Isometry3d::Identity();
};

/// Everything in a map, as a value: what the store reads and writes. Keys equal the ids of the values.
struct MapContent {
  std::map<PlaceId, Place> places;
  std::map<ViewId, View> views;
  std::map<EdgeId, Edge> edges;
  std::vector<PathPoint> path;
  memory::Redetections redetections;                        ///< of the features of all places
  std::uint32_t nextPlace = 0, nextView = 0, nextEdge = 0;  ///< ids are never reused
  std::shared_ptr<const Derived> derived;  ///< of the map as it was opened; null where nothing is kept
};

/// Broken rules of a place, an edge, … in words; empty when all is well. Ends and ids are checked by
/// brokenRules(). Of a place whose memory was not read yet, the memory is not looked at.
std::string brokenRule(const MapHeader& header);
std::string brokenRule(const memory::PlaceMemory& memory);
/// Whether it is of the descriptors that the header names.
std::string brokenRule(const MapHeader& header, const memory::PlaceMemory& memory);
std::string brokenRule(const Place& place);
std::string brokenRule(const View& view);
std::string brokenRule(const Edge& edge);
std::string brokenRule(const PathPoint& point);

/// Every broken rule of the whole map, as far as it was read, one sentence each.
std::vector<std::string> brokenRules(const MapContent& content);

/// Every place whose descriptors are not those of the header, one sentence each.
std::vector<std::string> brokenRules(const MapHeader& header, const MapContent& content);

}  // namespace engram::map
