// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/belief/motion_model.h"

#include <cmath>

namespace engram::belief {

inline double gaussian(double x, double sigma) { return std::exp(-0.5 * (x / sigma) * (x / sigma)); }

/// The sum of each layer, from its first value to its last. Several at a time: a sum waits for itself.
std::vector<double> sums(const Layers& layers);

/// Mass of a place and layer that is not worth moving. In a map of more than 200 places all that is left
/// where it is holds no more than 1 %: what is moved is where the robot may be, not all that it is at by
/// accident alone, and a robot that knows where it is pays for its surroundings, not for the map.
double nothing(std::size_t places, std::size_t layers, double inSmallMaps);

/// F eq (7): a Gaussian on hops, see F-E2. Knows nothing but the place.
class BlindMotion : public MotionModel {
 public:
  explicit BlindMotion(const BeliefParams& params) : params_(params) {}
  /// Every layer by itself. Each row of the transition is normalised.
  void move(const Adjacency& adjacency, const Layers& from, const MotionHint& hint, Layers& to) override;

 private:
  BeliefParams params_;
};

/// The layers are steps along the chain of places. A step is like the one before, or drawn from a
/// distribution of steps that is learnt as it goes: expected counts under the posterior, with forgetting
/// (online EM). It begins symmetric, so a robot that never moves on, or backwards, is served as well.
class ChainMotion : public MotionModel {
 public:
  explicit ChainMotion(const BeliefParams& params);

  std::size_t layers() const override { return steps_.size(); }
  double share(std::size_t k) const override { return steps_[k]; }
  void reset() override { steps_ = learnt_ = blindSteps_; }
  void learn(const Layers& joint, double known) override;
  void move(const Adjacency& adjacency, const Layers& from, const MotionHint& hint, Layers& to) override;

  /// Step k [places/image].
  double size(std::size_t k) const;

 private:
  static std::vector<std::vector<int>> stepsAlong(const Adjacency& adjacency, int furthest);
  Layers choose(const Layers& from, const MotionHint& hint) const;
  std::vector<double> moveAlong(const Adjacency& adjacency, const Layers& from, Layers& to) const;

  BeliefParams params_;
  BlindMotion blind_;
  std::vector<double> blindSteps_, steps_, learnt_;
};

/// mass moves in the direction and over the distance that odometry reports. The layers are rotations
/// between the frame of odometry and the map; the robot keeps to one of them, but for slow drift. What would
/// leave the map is lost: it is anywhere.
class OdometryMotion : public MotionModel {
 public:
  explicit OdometryMotion(const BeliefParams& params) : params_(params), blind_(params) {}

  std::size_t layers() const override { return static_cast<std::size_t>(params_.advance_headings); }
  double share(std::size_t) const override { return 1.0 / params_.advance_headings; }
  void reset() override;
  void move(const Adjacency& adjacency, const Layers& from, const MotionHint& hint, Layers& to) override;
  bool seesAll() const override { return params_.view_sigma <= 0 || headings_.empty(); }
  double visible(std::size_t layer, std::size_t place) const override;

 private:
  double rotation(std::size_t layer) const;

  BeliefParams params_;
  BlindMotion blind_;
  std::vector<double> headings_;  // of the places in the map [rad]; empty: nothing is known of the robot's
  double heading_ = 0.0;          // of the robot in the frame of odometry [rad]
  Eigen::Vector2d pending_ = Eigen::Vector2d::Zero();  // motion that the mass has not followed yet [m]
};

}  // namespace engram::belief
