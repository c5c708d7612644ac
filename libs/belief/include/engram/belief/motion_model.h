// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/belief/adjacency.h"
#include "engram/belief/belief_params.h"

#include <Eigen/Core>

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace engram::belief {

/// What wheels say of the motion since the last image, on the floor.
struct OdometryStep {
  Eigen::Vector2d step = Eigen::Vector2d::Zero();  ///< in the frame of odometry [m]
  double heading = 0.0;                            ///< of the robot in that frame, after the step [rad]
  double spacing = 1.0;                            ///< mean distance of neighbouring places [m]
};

/// What is known of the motion since the last image.
struct MotionHint {
  std::optional<double> hops{};  ///< distance travelled over the mean distance of neighbouring places, >= 0
  std::optional<OdometryStep> odometry{};
};

/// p(place, layer): one vector over places for each value of what a motion model knows beside the place.
using Layers = std::vector<std::vector<double>>;

/// The transition of the filter. It may split each place into layers, to remember how the robot moves.
class MotionModel {
 public:
  virtual ~MotionModel() = default;

  virtual std::size_t layers() const { return 1; }
  /// Share of layer k in mass of which only the place is known; they sum to 1.
  virtual double share(std::size_t) const { return 1.0; }
  /// Forgets what it has learnt.
  virtual void reset() {}
  /// Learns from the belief after an image. @param known mass of all places
  virtual void learn(const Layers& /*joint*/, double /*known*/) {}
  /// Moves the mass of `from` and adds it to `to`; its sum stays the same.
  virtual void move(const Adjacency& adjacency, const Layers& from, const MotionHint& hint, Layers& to) = 0;
  /// Whether the camera sees every place from every layer: visible() is 1 then.
  virtual bool seesAll() const { return true; }
  /// Weight of the evidence for a place in layer k, 1 in the mean: whether the camera would show it.
  virtual double visible(std::size_t /*layer*/, std::size_t /*place*/) const { return 1.0; }
};

/// By BeliefParams::advance: F eq (7) alone, steps along the chain of places that are learnt, or odometry.
std::unique_ptr<MotionModel> makeMotionModel(const BeliefParams& params);

}  // namespace engram::belief
