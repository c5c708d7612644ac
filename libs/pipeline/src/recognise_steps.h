// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/pipeline/landings.h"
#include "engram/pipeline/recogniser.h"
#include "engram/pipeline/view_search.h"
#include "steps.h"

#include <utility>

namespace engram::pipeline {

/// A score for each place, and a belief over all of them (F-19, F-20).
class BeliefStep final : public RecogniseStep {
 public:
  explicit BeliefStep(std::shared_ptr<Recogniser> recogniser) : recogniser_(std::move(recogniser)) {}
  Evidence recognise(Run& run, const Keyframe& image, types::FrameReport& report) override;
  void restart() override { recogniser_->restart(); }

 private:
  std::shared_ptr<Recogniser> recogniser_;
};

/// The views that an index proposes (K-14); nothing is believed from image to image.
class IndexStep final : public RecogniseStep {
 public:
  explicit IndexStep(const Run& run) : search_(run.params) { search_.load(run.map); }
  Evidence recognise(Run& run, const Keyframe& image, types::FrameReport& report) override;

 private:
  ViewSearch search_;
};

/// One place after the other, until one is accepted: where odometry puts the robot in known ground; what the
/// belief proposes in the order of the posterior (A-18, A-E13); then what geometry alone may find (K-15,
/// K-21); then the place that odometry says, and the one just made. A leap through the map is not taken while
/// another place explains the image about as well.
class OnePlaceStep final : public VerifyStep {
 public:
  /// What an accepted place must agree with beside its own geometry.
  enum class Fit {
    kWay,     ///< the way since the last one; a leap needs the matches of a loop closure
    kTerrain  ///< that, and the image must not be of a new place beside it (F-07)
  };
  OnePlaceStep(std::shared_ptr<Recogniser> recogniser, Fit fit)
      : recogniser_(std::move(recogniser)), fit_(fit) {}
  Verified verify(Run& run, const Keyframe& image, Evidence evidence, types::FrameReport& report) override;

 private:
  bool expected(Run& run, const Keyframe& image, Verified& verified, types::FrameReport& report);
  bool sameSpot(Run& run, const Keyframe& image, Verified& verified, types::FrameReport& report);
  bool believed(Run& run, const Keyframe& image, Verified& verified, types::FrameReport& report);
  bool similar(Run& run, const Keyframe& image, Verified& verified, types::FrameReport& report);
  void beside(Run& run, const Keyframe& image, Verified& verified);
  void linkAnchor(Run& run, const Keyframe& image, Verified& verified);
  void findEchoes(Run& run, const Keyframe& image, Verified& verified);
  base::PlaceId bySequence(const Run& run, const Verified& verified) const;
  bool accepts(Run& run, const Keyframe& image, Link& link, Verified& verified);
  bool mayJoin(Run& run, const Keyframe& image, const Link& link);
  bool lessThanTheLast(Run& run, const Keyframe& image, const Link& link);
  bool ambiguous(Run& run, const Keyframe& image, const Link& link, Verified& verified,
                 types::FrameReport& report);

  std::shared_ptr<Recogniser> recogniser_;
  Fit fit_;
  Landings joins_, contradictions_;
};

/// All views that geometry confirms, not the best alone (K-05).
class AllViewsStep final : public VerifyStep {
 public:
  Verified verify(Run& run, const Keyframe& image, Evidence evidence, types::FrameReport& report) override;
};

}  // namespace engram::pipeline
