// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/holdings.h"
#include "engram/map/topological_map.h"
#include "engram/pipeline/params.h"
#include "engram/pipeline/recogniser.h"
#include "engram/types/features.h"
#include "engram/types/frame.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace engram::apps {

/// One view that a contender learns from, with the motion that led to it.
struct LearnView {
  types::Frame frame;  ///< stamp and odometry; the image is not looked at
  types::Features features;
};

/// What became of one drive that was learnt from.
struct Learning {
  int views = 0;
  int accepted = 0;  ///< localised with enough evidence to learn from
  int wrong = 0;     ///< of the accepted, at a wrong place
  int learnt = 0;    ///< updates of a place
};

/// A way of remembering places, under test. All contenders see the same views, localise with the same belief
/// filter, and learn only what the same geometric check confirms (F-27, F-E16).
class Contender {
 public:
  virtual ~Contender() = default;

  /// Learns from a drive, view by view, at the places where it finds itself.
  /// @param isRight whether view i of the drive shows this place; only counted, never used to learn
  using Verdict = std::function<bool(std::size_t i, base::PlaceId place)>;
  virtual Learning learn(const std::vector<LearnView>& drive, const Verdict& isRight) = 0;

  /// How much this view looks like each place, in [0, 1]; input of the sensor model F eq (9). Thread-safe.
  virtual std::vector<double> scores(const types::Features& view) const = 0;

  virtual Holdings holdings() const = 0;
  /// Places and edges; the filter runs on these.
  virtual const map::TopologicalMap& map() const = 0;
};

/// How places are remembered, by name.
struct Method {
  std::string name;
  pipeline::PipelineParams params;
  int words = 0;  ///< size of the k-means dictionary of the bag of words; 0: a memory model
};

/// A map of one drive: one place for each view, neighbours joined; with `closed` the last with the first.
std::unique_ptr<Contender> makeContender(const Method& method, const std::vector<LearnView>& tour,
                                         const std::vector<Eigen::Isometry3d>& T_map_robot, bool closed);

}  // namespace engram::apps
