// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/parts.h"
#include "engram/memory/static_view.h"
#include "engram/odometry/stereo_check.h"
#include "engram/odometry/stereo_odometry.h"
#include "engram/pipeline/dead_reckoning.h"
#include "engram/pipeline/map_builder.h"
#include "engram/pipeline/map_relaxer.h"
#include "engram/pipeline/perception.h"
#include "engram/pipeline/place_match.h"
#include "engram/pipeline/view_search.h"
#include "engram/upkeep/upkeep.h"

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

namespace engram::pipeline {

/// The features of a stereo view: the strongest whose range is known, at most so many (K-38).
types::Features viewFeatures(const Perception& perception, const types::StereoPair& pair, int most);

/// Builds or extends a map of stereo views (Konolige & Bowman 2009): visual odometry from view to view, links
/// to all views of the map that geometry confirms, weak links where nothing is known, and views forgotten by
/// rule. process() is K-19, step by step. Every view is a node of the map, a place with one static memory.
class ViewMapper final : public MapBuilder {
 public:
  /// @param map empty, or a map of views to extend: the robot then starts anywhere, in it or outside.
  /// Throws base::Error on a calibration or vocabulary that cannot be read, base::ConfigError on parameters
  /// that do not suit stereo views.
  ViewMapper(const PipelineParams& params, map::TopologicalMap map = {});
  ~ViewMapper() override;

  types::FrameReport process(const types::Frame& frame) override;
  void finish() override;
  const map::TopologicalMap& map() const override { return map_; }
  map::TopologicalMap& map() override { return map_; }
  int session() const override { return session_; }
  map::MapHeader header() const override { return perception_.mapHeader(params_.memory.memory); }
  std::optional<odometry::StereoHealth> eyes() const override { return check_.health(); }

 private:
  struct Work;
  struct Link {
    base::PlaceId to;
    PlaceMatch match;
  };

  bool perceive(Work& work);
  bool move(Work& work);
  bool select(Work& work);
  bool describe(Work& work);
  void recognise(Work& work);
  void verify(Work& work);
  void remember(Work& work);
  void relate(Work& work);
  void forget(Work& work);
  void relax(Work& work);

  std::optional<Eigen::Isometry3d> eyeStep(const types::Frame& frame);
  std::string whyLost(odometry::OdometryReason reason) const;
  std::optional<Link> linkTo(const Work& work, base::PlaceId view) const;
  Eigen::Isometry3d guessedPose(const Work& work) const;
  base::PlaceId lastPlace() const;
  map::Edge edgeOf(const Link& link, base::PlaceId view) const;
  types::RelPose floored(types::RelPose T) const;
  std::optional<types::RelPose> motionSinceAnchor() const;
  void addMotion(Work& work);
  void addLink(Work& work, const Link& link);
  bool isSure(const Link& link) const;
  bool agrees(const Work& work, const Link& link);
  bool tooFast(const Work& work, const types::RelPose& T_anchor_robot) const;
  void linkNeighbours(Work& work);
  bool joined(base::PlaceId a, base::PlaceId b);
  base::EdgeId addEdge(map::Edge edge);
  double disagreement(const std::vector<base::EdgeId>& edges) const;

  PipelineParams params_;
  Perception perception_;
  memory::Static memory_;
  odometry::StereoOdometry odometry_;
  odometry::StereoCheck check_;
  ViewSearch search_;
  MapRelaxer relaxer_;
  map::TopologicalMap map_;
  upkeep::Budget budget_;

  int session_ = 0;
  map::Parts parts_;
  base::PlaceId anchor_;              // the newest view of this drive, or its heir; invalid at wake-up
  double anchorStamp_ = 0;            // [s]
  types::RelPose T_anchor_keyframe_;  // of the robot at the keyframe of the odometry
  types::RelPose T_anchor_robot_;     // as last known
  double stamp_ = 0;                  // [s] of T_anchor_robot_
  double sinceClosure_ = 0;           // [m] driven since a link last closed a loop
  std::size_t relaxedAt_ = 0;         // views of this drive when the whole map was last relaxed
  std::size_t made_ = 0;              // views of this drive
  bool lost_ = true;                  // nothing measured joins the robot to the anchor
  DeadReckoning wheels_;              // from the anchor
  std::optional<Eigen::Isometry3d> T_odom_last_;
};

}  // namespace engram::pipeline
