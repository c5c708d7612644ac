// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/parts.h"
#include "engram/memory/place_memory.h"
#include "engram/pipeline/closure_book.h"
#include "engram/pipeline/dead_reckoning.h"
#include "engram/pipeline/map_builder.h"
#include "engram/pipeline/map_relaxer.h"
#include "engram/pipeline/params.h"
#include "engram/pipeline/pass_gate.h"
#include "engram/pipeline/perception.h"
#include "engram/pipeline/place_match.h"
#include "engram/pipeline/recogniser.h"
#include "engram/types/frame.h"
#include "engram/types/frame_report.h"

#include <memory>
#include <optional>
#include <vector>

namespace engram::pipeline {

/// Builds or extends a map of places: the nine steps of the design, in process().
class Mapper final : public MapBuilder {
 public:
  /// @param map empty, or a map to extend: the robot then starts at an unknown place of it.
  /// Throws base::Error on a calibration that cannot be read, base::ConfigError on parameters out of range.
  Mapper(const PipelineParams& params, map::TopologicalMap map = {});

  types::FrameReport process(const types::Frame& frame) override;
  void finish() override;
  const map::TopologicalMap& map() const override { return map_; }
  map::TopologicalMap& map() override { return map_; }
  int session() const override { return session_; }
  map::MapHeader header() const override { return perception_.mapHeader(params_.memory.memory); }
  std::optional<odometry::StereoHealth> eyes() const override { return perception_.eyes(); }

 private:
  struct Work;
  using Candidate = std::pair<base::PlaceId, PlaceMatch>;

  bool perceive(Work& work);
  void move(Work& work);
  bool select(Work& work);
  void recognise(Work& work);
  void verify(Work& work);
  void decide(Work& work);
  void remember(Work& work);
  void relate(Work& work);
  void relax(Work& work);

  bool verifyBelieved(Work& work);
  bool verifySimilar(Work& work);
  bool tryPlace(Work& work, base::PlaceId id, bool mayAccept = true);

  bool metric() const { return reckoning_.anchored() && anchor_.valid(); }
  bool isRecent(base::PlaceId place) const;
  Eigen::Isometry3d T_place_robot(base::PlaceId place) const;
  std::optional<std::pair<base::PlaceId, double>> nearestByOdometry() const;
  bool isClosure(base::PlaceId place) const;
  bool belongsTo(base::PlaceId place, const PlaceMatch& match) const;
  types::RelPose atPlace(const Candidate& candidate) const;
  map::Edge closureTo(const Work& work, const Candidate& candidate) const;
  void refuse(Work& work, posegraph::ClosureReason reason) const;
  map::EdgeType closureType(base::PlaceId to) const;
  base::PlaceId cameFrom() const;
  void addPlace(Work& work);
  void addEdges(const Work& work, base::PlaceId from, base::PlaceId place);
  types::RelPose motionFrom(const Work& work, base::PlaceId from) const;
  void addView(const Work& work, base::PlaceId place, int thumbnailWidth);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> correspondences(const PlaceMatch& match,
                                                                       base::PlaceId a,
                                                                       base::PlaceId b) const;
  void joinPlace(Work& work, const Candidate& candidate);
  void applyJudgement(Work& work);

  PipelineParams params_;
  Perception perception_;
  std::unique_ptr<memory::MemoryModel> memory_;
  PassGate gate_;
  Recogniser recogniser_;
  MapRelaxer relaxer_;
  DeadReckoning reckoning_;  // from the anchor
  DeadReckoning sinceMade_;  // from the place made last in this drive: wheels alone
  ClosureBook closures_;
  map::TopologicalMap map_;
  map::Parts parts_;

  int session_ = 0;
  base::PlaceId anchor_;            // where the robot was last certain to be; invalid at wake-up
  base::PlaceId made_;              // the place made last in this drive
  base::EdgeId anchoredBy_;         // the closure that the anchor rests on; invalid when it rests on none
  std::set<base::PlaceId> recent_;  // places made in a row, near the newest one, while the robot goes on
  bool frontier_ = true;         // the robot has just made places and is not known to be back in older ones
  int misses_ = 0;               // unrecognised images in a row in known territory
  bool closedUnmetric_ = false;  // a closure without odometry waits for relaxation
  types::Features lastKeyframe_;
};

}  // namespace engram::pipeline
