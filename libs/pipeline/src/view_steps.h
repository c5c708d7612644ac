// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/memory/static_view.h"
#include "engram/pipeline/map_relaxer.h"
#include "engram/upkeep/upkeep.h"
#include "steps.h"

#include <map>

namespace engram::pipeline {

// Maps of stereo views (Konolige & Bowman 2009): every image that is taken up is a node.

class ViewDecide final : public DecideStep {
 public:
  Decision decide(Run&, const Keyframe&, const Verified&, types::FrameReport& report) override;
};

/// K-19, step 5.b.i: the image becomes a view of the map.
class ViewRemember final : public RememberStep {
 public:
  base::PlaceId remember(Run& run, const Keyframe& image, const Verified& verified, const Decision& decision,
                         types::FrameReport& report) override;

 private:
  memory::Static memory_;
};

/// Step 5.b.ii, A and B: links, and a weak one where nothing measured joins the view to where the robot was.
/// A view that odometry could not join to the last one is taken up once the next image confirms it: a run of
/// failures leaves one view and one weak link (K-E10).
class ViewRelate final : public RelateStep {
 public:
  /// @param budget of forgetting, which asks which views nearby agree; none when nothing is forgotten
  explicit ViewRelate(std::optional<upkeep::Budget> budget) : budget_(std::move(budget)) {}
  Relation relate(Run& run, const Keyframe& image, const Verified& verified, const Decision& decision,
                  base::PlaceId node, types::FrameReport& report) override;

 private:
  using Near = std::map<base::PlaceId, int>;  ///< views that the graph has near already: others are closures

  void addMotion(Run& run, const Verified& verified, const types::RelPose& motion, base::PlaceId node) const;
  void addWeak(Run& run, base::PlaceId node) const;
  void addLink(Run& run, const Link& link, const Near& near, Relation& relation,
               types::FrameReport& report) const;
  void linkNeighbours(Run& run, const Keyframe& image, const Verified& verified, const Near& near,
                      Relation& relation, types::FrameReport& report) const;
  bool agrees(Run& run, const Link& link, base::PlaceId node, const Near& near) const;

  std::optional<upkeep::Budget> budget_;
  double sinceClosure_ = 0;  // [m] driven since a link last closed a loop
};

/// Step 5.b.ii, C (K-28).
class LruForget final : public ForgetStep {
 public:
  explicit LruForget(upkeep::Budget budget) : budget_(std::move(budget)) {}
  void forget(Run& run, const Relation& relation, types::FrameReport& report) override;

 private:
  upkeep::Budget budget_;
};

/// Step 5.b.ii, D: as much of the graph as the new links ask for (K-10).
class ViewRelax final : public RelaxStep {
 public:
  explicit ViewRelax(const Run& run) : relaxer_(run.params.posegraph) {}
  void relax(Run& run, const Relation& relation, types::FrameReport& report) override;
  void finish(Run& run) override { relaxer_.all(run.map); }

 private:
  MapRelaxer relaxer_;
  std::size_t made_ = 0;       // views of this drive
  std::size_t relaxedAt_ = 0;  // of them, when the whole map was last relaxed
};

}  // namespace engram::pipeline
