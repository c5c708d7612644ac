// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/memory/place_memory.h"
#include "engram/pipeline/map_relaxer.h"
#include "engram/pipeline/pass_gate.h"
#include "place_lessons.h"
#include "steps.h"

namespace engram::pipeline {

// Maps of places that remember.

/// Recognised, new, or refused. A loop closure enters only if the graph does not deny it.
class PlaceDecide final : public DecideStep {
 public:
  Decision decide(Run& run, const Keyframe& image, const Verified& verified,
                  types::FrameReport& report) override;

 private:
  void judge(Run& run, const Verified& verified, Decision& decision, types::FrameReport& report) const;
  void judgeEchoes(Run& run, std::span<const Link> echoes, base::PlaceId here,
                   const types::RelPose& T_here_robot, types::FrameReport& report) const;
  bool isNew(const Run& run, types::FrameReport& report);

  int misses_ = 0;  // unrecognised images in a row in known territory
};

/// Known or not; the map has no room for anything new.
class KnownDecide final : public DecideStep {
 public:
  Decision decide(Run& run, const Keyframe& image, const Verified& verified,
                  types::FrameReport& report) override;
};

/// A new place, or a known one that learns at once.
class PlaceRemember final : public RememberStep {
 public:
  explicit PlaceRemember(const Run& run);
  base::PlaceId remember(Run& run, const Keyframe& image, const Verified& verified, const Decision& decision,
                         types::FrameReport& report) override;
  std::vector<base::PlaceId> finish(Run& run) override;

 private:
  base::PlaceId newPlace(Run& run, const Keyframe& image, const Verified& verified,
                         types::FrameReport& report);
  std::unique_ptr<memory::MemoryModel> memory_;
  PassGate gate_;
};

/// A frozen map: nothing is remembered.
class NothingRemembered final : public RememberStep {
 public:
  base::PlaceId remember(Run&, const Keyframe&, const Verified&, const Decision&,
                         types::FrameReport&) override {
    return {};
  }
};

/// Places of a finished map learn, and only what was verified, once the places accepted before agree with it
/// (F-E16, X-07): one wrong answer that is learnt makes the next one look right. A standing robot learns
/// once. A place learns when the robot has left its surroundings: images in a row resemble each other more
/// than any remembered view. A place that learnt at once would go on being the best match as the robot drives
/// away, learn again, and draw to itself what belongs to its neighbours.
class LaterRemember final : public RememberStep {
 public:
  explicit LaterRemember(const Run& run);
  base::PlaceId remember(Run& run, const Keyframe& image, const Verified& verified, const Decision& decision,
                         types::FrameReport& report) override;
  std::vector<base::PlaceId> finish(Run& run) override;
  void restart() override { gate_.restart(); }

 private:
  void learnDistant(Run& run, base::PlaceId here, types::FrameReport& report);
  void learn(Run& run, const Lesson& lesson, types::FrameReport& report) const;

  std::unique_ptr<memory::MemoryModel> memory_;
  PassGate gate_;
  double sinceLearning_;         // [m] travelled since a place last learnt
  std::vector<Lesson> lessons_;  // in the order of their images
};

/// F algorithm 2 as printed: the most probable place learns each image at once, whatever geometry says of it.
/// For experiments (F-E16).
class UngatedRemember final : public RememberStep {
 public:
  explicit UngatedRemember(const Run& run);
  base::PlaceId remember(Run& run, const Keyframe& image, const Verified& verified, const Decision& decision,
                         types::FrameReport& report) override;
  std::vector<base::PlaceId> finish(Run& run) override;
  void restart() override { gate_.restart(); }

 private:
  std::unique_ptr<memory::MemoryModel> memory_;
  PassGate gate_;
};

/// A new place is joined to where the robot came from; at a known one a closure enters where the graph had no
/// short way, and the robot goes on from there.
class PlaceRelate final : public RelateStep {
 public:
  Relation relate(Run& run, const Keyframe& image, const Verified& verified, const Decision& decision,
                  base::PlaceId node, types::FrameReport& report) override;

 private:
  void joinNew(Run& run, const Verified& verified, base::PlaceId node) const;
  bool joinKnown(Run& run, const Verified& verified, const Decision& decision,
                 types::FrameReport& report) const;
};

/// Only the robot moves.
class FollowRelate final : public RelateStep {
 public:
  Relation relate(Run& run, const Keyframe& image, const Verified& verified, const Decision& decision,
                  base::PlaceId node, types::FrameReport& report) override;
};

/// The judgement over closures has relaxed the whole graph already; a place with more than one edge asks for
/// its surroundings.
class PlaceRelax final : public RelaxStep {
 public:
  explicit PlaceRelax(const Run& run)
      : relaxer_(run.params.posegraph), firstEdge_(run.map.content().nextEdge) {}
  void relax(Run& run, const Relation& relation, types::FrameReport& report) override;
  void finish(Run& run) override;

 private:
  MapRelaxer relaxer_;
  std::uint32_t firstEdge_;  // of this drive
};

/// The place that a new one is joined to: the anchor, or at wake-up the last one of the map (K-19).
/// @param made the new one, if the map has it already
base::PlaceId cameFrom(const Run& run, base::PlaceId made = {});

/// A node made of an image, and the image kept as its view.
base::PlaceId addNode(Run& run, const Keyframe& image, const Eigen::Isometry3d& T_map_place,
                      memory::PlaceMemory memory);
void addView(Run& run, const Keyframe& image, base::PlaceId place, int thumbnailWidth);

}  // namespace engram::pipeline
