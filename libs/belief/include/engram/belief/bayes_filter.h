// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/belief/adjacency.h"
#include "engram/belief/belief_params.h"
#include "engram/belief/likelihood.h"
#include "engram/belief/motion_model.h"

#include <memory>
#include <vector>

namespace engram::belief {

/// Probabilities of all places and of the new-place state; they sum to 1.
struct Belief {
  std::vector<double> places;
  double newPlace = 0.0;  ///< always 0 without that state
};

/// Discrete Bayes filter over the places of a map, F eq (5), (6); A eq (10).
///
/// For each image: predict(), then update() once for each independent observation. Without the new-place
/// state it localises in a frozen map; with it, it decides between the map and somewhere else.
///
/// With `filter = winner_takes_all` (D-03) no image knows of those before it: predict() does nothing, and
/// update() gives everything to the state that is most likely, the first of equal ones.
///
/// The motion model is chosen by `advance`. With `learned` the state is the place and the last step along the
/// chain of places; with `odometry` it is the place and the rotation between odometry and map.
class BayesFilter {
 public:
  /// Throws base::ConfigError naming the key.
  BayesFilter(BeliefParams params, bool hasNewPlace);

  /// Forgets everything: all places equal (F-17, A-15), the new place at its prior (1 on an empty map).
  void reset(std::size_t places);

  /// Adds places at the end. They share `massOfAdded`, taken from all others in proportion, but first from
  /// the new-place state: what was somewhere else is now there.
  void grow(std::size_t places, double massOfAdded);

  /// p(x_t | z_1..t-1). `adjacency` must have as many places as the filter.
  void predict(const Adjacency& adjacency, const MotionHint& hint = {});

  /// p(x_t | z_1..t). False, and nothing changes, when the likelihood excludes everything that is believed
  /// possible. Throws std::invalid_argument for values that are negative or not finite, or of the wrong
  /// number.
  bool update(const Likelihood& likelihood);

  const Belief& posterior() const { return belief_; }

  /// The most probable place, the first of equal ones; -1 on an empty map. The new place does not compete.
  int best() const;

  /// Sum of the posterior over the places within `hops` of `place`.
  double neighbourhoodMass(const Adjacency& adjacency, int place, int hops) const;

  /// Sub-place estimate (F-E14): `place` plus the posterior-weighted mean of -1, 0, +1 for its predecessor,
  /// itself and its successor. A number along the chain, within half a place of it when `place` is the best
  /// one.
  double interpolatedPeak(const Adjacency& adjacency, int place) const;

  /// `advance = learned`: a step along the chain of places, and its learnt probability.
  struct Step {
    double size;  ///< [places/image]
    double probability;
  };
  /// Ascending by size; empty with any other motion model.
  std::vector<Step> learntSteps() const;

  const BeliefParams& params() const { return params_; }

 private:
  void crown(const Likelihood& likelihood);
  void spread(Layers& to, double mass) const;
  void setJoint(Layers joint, double newPlace);

  BeliefParams params_;
  bool hasNewPlace_;
  bool winnerTakesAll_;
  bool stepped_ = false;
  std::unique_ptr<MotionModel> motion_;
  Layers joint_;  ///< p(place, layer of the motion model)
  Belief belief_;
};

}  // namespace engram::belief
