// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/parts.h"
#include "engram/pipeline/closure_book.h"
#include "engram/pipeline/params.h"
#include "engram/pipeline/perception.h"
#include "engram/pipeline/place_match.h"
#include "engram/pipeline/way_scale.h"
#include "engram/pipeline/whereabouts.h"
#include "engram/types/frame.h"
#include "engram/types/frame_report.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace engram::pipeline {

/// What all steps of a run share.
struct Run {
  PipelineParams params;
  Perception perception;
  map::TopologicalMap map;
  map::Parts parts;  ///< of the map; to be asked after follow() alone
  ClosureBook closures;
  Whereabouts robot;
  int session = 0;
  WayScale scale{};  ///< of the map, by this drive

  /// Whether passages of the map join two places.
  bool joined(base::PlaceId a, base::PlaceId b) {
    parts.follow(map);
    return parts.joined(a, b);
  }
};

// The values that pass from step to step.

/// Perceive: an image that can be used.
struct Seen {
  const types::Frame& frame;
  types::Features features{};  ///< empty where only keyframes are described
  types::StereoPair pair{};    ///< rectified; empty where only features are looked at
};

/// Move: what odometry found, beside where the robot is now.
struct Motion {
  bool keyframe = false;  ///< visual odometry goes on from this image
};

/// Select: an image that is taken up.
struct Keyframe {
  const types::Frame& frame;
  types::Features features;
  cv::Mat picture;
  std::optional<Travel> travel;  ///< by the wheels since the keyframe before
  double distance = 0;           ///< the same along the way [m], as far as they know
};

/// Recognise: places that the image may be of, best first.
struct Evidence {
  std::vector<types::Hypothesis> hypotheses;
};

/// A place and how the image matches it: the pose as far as geometry knows it.
struct Link {
  base::PlaceId place;
  PlaceMatch match;
  bool overrules = false;  ///< two images agree against odometry on where the robot is
};

/// Verify: what geometry says of the places that the image was held against.
struct Verified {
  std::vector<base::PlaceId> tried;
  std::vector<Link> links;
  std::optional<Link> accepted;  ///< the place where the robot is, when one suffices
  base::PlaceId bySequence{};    ///< none is accepted, but images before and this one together say where
  std::string reason;            ///< why none was accepted, in words, where verification knows
  bool doubtful = false;         ///< a place was not accepted because odometry contradicts it alone
  /// Places that the graph has no short way to and that the image shows beside the accepted one, or while
  /// none is: the same ground, perhaps, that the robot once came to by another way. The graph judges them.
  std::vector<Link> echoes;
  /// The image held against the scan before, which is no place; its own is invalid.
  std::optional<Link> previous;
};

/// Decide: known, new, or neither.
struct Decision {
  bool makesNode = false;
  std::optional<Link> known{};
  types::RelPose T_known_robot{};  ///< where the robot is, seen from it
  bool agrees = true;              ///< the known place with the way since the last one
  bool judged = false;             ///< the closure that it means was judged: the map has followed
  std::vector<Link> agreed{};      ///< links to reference scans that agree with where the robot is
};

/// Relate: the edges that are new.
struct Relation {
  base::PlaceId node{};  ///< that the image made; invalid otherwise
  std::vector<base::EdgeId> edges{};
  bool joined = false;    ///< parts of the map that nothing measured had joined before
  bool unmetric = false;  ///< a closure without odometry: it bends all
};

// The steps. Each is a strategy that a recipe chooses; what it decides goes into the record, too.

class PerceiveStep {
 public:
  virtual ~PerceiveStep() = default;
  virtual std::optional<Seen> perceive(Run& run, const types::Frame& frame, types::FrameReport& report) = 0;
};

class MoveStep {
 public:
  virtual ~MoveStep() = default;
  virtual std::optional<Motion> move(Run& run, const Seen& seen, types::FrameReport& report) = 0;
};

class SelectStep {
 public:
  virtual ~SelectStep() = default;
  virtual std::optional<Keyframe> select(Run& run, Seen seen, const Motion& motion,
                                         types::FrameReport& report) = 0;
};

class RecogniseStep {
 public:
  virtual ~RecogniseStep() = default;
  virtual Evidence recognise(Run& run, const Keyframe& image, types::FrameReport& report) = 0;
  /// The robot is lost: every place is equally likely again.
  virtual void restart() {}
};

class VerifyStep {
 public:
  virtual ~VerifyStep() = default;
  virtual Verified verify(Run& run, const Keyframe& image, Evidence evidence, types::FrameReport& report) = 0;
};

class DecideStep {
 public:
  virtual ~DecideStep() = default;
  virtual Decision decide(Run& run, const Keyframe& image, const Verified& verified,
                          types::FrameReport& report) = 0;
};

class RememberStep {
 public:
  virtual ~RememberStep() = default;
  /// The node that the image made; invalid when it made none.
  virtual base::PlaceId remember(Run& run, const Keyframe& image, const Verified& verified,
                                 const Decision& decision, types::FrameReport& report) = 0;
  /// The drive has ended. Returns the places that learn now.
  virtual std::vector<base::PlaceId> finish(Run&) { return {}; }
  /// The robot is lost.
  virtual void restart() {}
};

class RelateStep {
 public:
  virtual ~RelateStep() = default;
  virtual Relation relate(Run& run, const Keyframe& image, const Verified& verified, const Decision& decision,
                          base::PlaceId node, types::FrameReport& report) = 0;
};

class ForgetStep {
 public:
  virtual ~ForgetStep() = default;
  virtual void forget(Run& run, const Relation& relation, types::FrameReport& report) = 0;
};

class RelaxStep {
 public:
  virtual ~RelaxStep() = default;
  virtual void relax(Run& run, const Relation& relation, types::FrameReport& report) = 0;
  virtual void finish(Run& run) = 0;
};

/// The strategies of a recipe.
struct Steps {
  std::unique_ptr<PerceiveStep> perceive;
  std::unique_ptr<MoveStep> move;
  std::unique_ptr<SelectStep> select;
  std::unique_ptr<RecogniseStep> recognise;
  std::unique_ptr<VerifyStep> verify;
  std::unique_ptr<DecideStep> decide;
  std::unique_ptr<RememberStep> remember;
  std::unique_ptr<RelateStep> relate;
  std::unique_ptr<ForgetStep> forget;  ///< none: nothing is forgotten
  std::unique_ptr<RelaxStep> relax;    ///< none: nothing moves
};

}  // namespace engram::pipeline
