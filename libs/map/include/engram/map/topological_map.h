// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/journal.h"
#include "engram/map/map_content.h"
#include "engram/memory/place_memory.h"
#include "engram/types/frame_report.h"
#include "engram/types/match.h"

#include <map>
#include <span>
#include <string>
#include <vector>

namespace engram::map {

struct Neighbour {
  PlaceId place;
  EdgeId edge;
  EdgeType type = EdgeType::kOdometry;
};

/// The sole owner of places, views, edges, memory and path. Every change is a method that keeps the
/// invariants; reading is by const reference only. Bad arguments throw base::Error and change nothing.
class TopologicalMap {
 public:
  TopologicalMap() = default;
  /// A map read from a file. Throws base::Error with the first broken rule.
  explicit TopologicalMap(MapContent content);

  /// The id of the argument is ignored, and so are its joint errors; the new id is returned.
  PlaceId addPlace(Place place);
  ViewId addView(View view);
  /// Needs known ends, a != b, a finite pose and a symmetric positive definite covariance. Correspondences
  /// that name features no longer remembered are dropped.
  EdgeId addEdge(Edge edge);
  void removeEdge(EdgeId id);
  /// The way of an edge becomes `factor` > 0 times as long: what measured it counts metres otherwise.
  void stretchEdge(EdgeId id, double factor);
  void addPathPoint(const PathPoint& point);
  /// Drops the path of all drives before this one; the map itself stays.
  void forgetPath(int firstKeptSession);
  /// Takes a place out, with its memory, its views and its edges. Path points tied to it stay where they are
  /// in the map and are tied to `heir`, another place. What else the edges said is the caller's to keep: see
  /// upkeep.
  void removePlace(PlaceId id, PlaceId heir);

  void setPose(PlaceId id, const Eigen::Isometry3d& T_map_place);
  void setPoses(const std::map<PlaceId, Eigen::Isometry3d>& T_map_place);
  /// Keeps how poses err. @param joint by place; `with` ends with it
  void setJointErrors(const std::map<PlaceId, JointErrors>& joint);
  /// Keeps what the rules of forgetting decided.
  void setStanding(PlaceId id, Standing standing, std::optional<double> matchedStamp);
  /// Keeps the true pose of a place, for evaluation.
  void survey(PlaceId id, const Eigen::Isometry3d& T_world_place);

  /// The place learns from a verified view, and the map how often features are seen again. Correspondences of
  /// its edges that name forgotten features are dropped.
  /// @param matches verified and one-to-one: a = feature of `view`, b = feature of the place's memory.
  types::MemoryChange remember(PlaceId id, const memory::MemoryModel& model, const types::Features& view,
                               std::span<const types::Match> matches);

  /// The place keeps how far features are that it did not know of; what it knows stays.
  /// @param ranges index of the feature, distance [m] > 0
  void measure(PlaceId id, std::span<const std::pair<int, float>> ranges);

  const std::map<PlaceId, Place>& places() const { return content_.places; }
  const std::map<ViewId, View>& views() const { return content_.views; }
  const std::map<EdgeId, Edge>& edges() const { return content_.edges; }
  const std::vector<PathPoint>& path() const { return content_.path; }
  const MapContent& content() const { return content_; }
  bool empty() const { return content_.places.empty(); }
  /// Throw base::Error for an unknown id.
  const Place& place(PlaceId id) const;
  const Edge& edge(EdgeId id) const;
  /// Pose of the robot at a path point, in the map frame.
  Eigen::Isometry3d T_map_robot(const PathPoint& point) const;
  /// One more than the largest session number of any place, view or path point; 0 for an empty map.
  int nextSession() const;

  /// Ids of the views of a place, ascending.
  const std::vector<ViewId>& viewsOf(PlaceId id) const;
  /// Places joined to this one by an edge, in the order of the edge ids.
  std::vector<Neighbour> neighbours(PlaceId id) const;
  /// Number of edges to every place within `maxHops` of `from` (0 for itself). Edges that are no
  /// passage do not count unless asked.
  std::map<PlaceId, int> hopDistances(PlaceId from, int maxHops, bool throughAll = false) const;
  /// Places that edges connect, of whatever type: ascending groups, ordered by their first place.
  std::vector<std::vector<PlaceId>> components() const;

  /// Throws base::Error with the first broken rule.
  void checkInvariants() const;

  /// The cursor of a reader who knows the map as it is.
  Cursor now() const { return {journal_.now(), content_.path.size()}; }
  /// What has changed since a reader last looked; moves its cursor. Every reader (the store, recognition, an
  /// index, a window) has its own.
  MapChanges changesSince(Cursor& cursor) const;
  /// The same with a cursor of the map's own, for a map with one reader.
  MapChanges takeChanges() { return changesSince(taken_); }

 private:
  /// What points at a place, in ascending order.
  struct Holds {
    std::vector<EdgeId> edges;
    std::vector<ViewId> views;
    std::vector<std::size_t> path;
  };

  Place& mutablePlace(PlaceId id);
  void dropForgotten(PlaceId id);

  MapContent content_;
  std::map<PlaceId, Holds> holds_;  // of every place
  Journal journal_;
  Cursor taken_;
};

}  // namespace engram::map
