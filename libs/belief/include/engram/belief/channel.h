// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/belief/bayes_filter.h"
#include "engram/belief/likelihood.h"

#include <optional>
#include <span>
#include <vector>

namespace engram::belief {

/// One kind of evidence among several, and how far it is trusted in this map at this hour: the share of
/// images for which its likelihood holds, while it says nothing of the others. The share is learnt from image
/// to image as in online expectation maximisation, from what all channels together came to believe: one that
/// does not tell the places apart, or tells another story than the others, loses its weight by itself.
class Channel {
 public:
  /// @param params with likelihood = standardised; `background` is the share that is never trusted
  /// @param trust to begin with
  Channel(BeliefParams params, double trust);

  /// @param newPlace as of belief::likelihood()
  Likelihood likelihood(std::span<const double> similarities, const Adjacency& adjacency,
                        std::optional<double> newPlace = {}) const;
  /// @param given what likelihood() said of this image. @param after the belief that weighed it
  void learn(const Likelihood& given, const Belief& after);

  /// A place that stands out of most images stands out of none: at night one street lamp on a map made by day
  /// may look like everything. Each place's usual deviates are learnt as their median is, from images that
  /// differ: a robot that stands teaches nothing. The likelihoods of the papers know of no such thing.
  /// @param similarities of one image, one a place
  void watch(std::span<const double> similarities);
  /// The same similarities without what places have of every image.
  std::vector<double> corrected(std::span<const double> similarities) const;

  /// How far it is trusted is forgotten. What places usually show stays: it is of the hour, not of the robot.
  void reset() { trust_ = first_; }

  double trust() const { return trust_; }
  const BeliefParams& params() const { return params_; }

 private:
  BeliefParams params_;
  double first_, trust_;
  std::vector<double> usual_;  // deviates of each place in most images; none before watch()
  std::vector<double> last_;   // of the last image
};

}  // namespace engram::belief
