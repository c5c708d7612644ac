// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/odometry/stereo_odometry.h"
#include "steps.h"

namespace engram::pipeline {

/// Every image becomes features at once.
class FeaturesStep final : public PerceiveStep {
 public:
  std::optional<Seen> perceive(Run& run, const types::Frame& frame, types::FrameReport& report) override;
};

/// Both eyes are rectified; what is taken up is described later.
class PairStep final : public PerceiveStep {
 public:
  std::optional<Seen> perceive(Run& run, const types::Frame& frame, types::FrameReport& report) override;
};

/// The wheels alone.
class WheelsStep final : public MoveStep {
 public:
  std::optional<Motion> move(Run& run, const Seen& seen, types::FrameReport& report) override;
};

/// Visual odometry against the last keyframe (K-19, steps 3 and 4), and the wheels beside it; where it fails
/// the robot is lost (K-E10).
class EyesStep final : public MoveStep {
 public:
  explicit EyesStep(const Run& run);
  std::optional<Motion> move(Run& run, const Seen& seen, types::FrameReport& report) override;

 private:
  bool follow(Run& run, const Seen& seen, const odometry::OdometryResult& found, types::FrameReport& report);
  std::optional<Eigen::Isometry3d> eyeStep(const Run& run, const types::Frame& frame);
  static std::string whyLost(const Run& run, odometry::OdometryReason reason);

  odometry::StereoOdometry odometry_;
  std::optional<Eigen::Isometry3d> T_odom_last_;
};

/// with A-E12 by odometry; F-07 without.
class MotionSelect final : public SelectStep {
 public:
  std::optional<Keyframe> select(Run& run, Seen seen, const Motion& motion,
                                 types::FrameReport& report) override;

 private:
  bool standing(Run& run, const Seen& seen, types::FrameReport& report);
  bool tooSimilar(const Run& run, const Seen& seen, types::FrameReport& report) const;
  double likeness(const Run& run, const Seen& seen) const;
  bool wheelsDead(Run& run, const Seen& seen);

  types::Features last_;
  int moved_ = 0;  // images that moved while the wheels stood
};

/// K-20: a view when the keyframe of visual odometry changes, but not too often. A lost robot takes the first
/// image that it can join to the next; odometry goes on from there.
class KeyframeSelect final : public SelectStep {
 public:
  std::optional<Keyframe> select(Run& run, Seen seen, const Motion& motion,
                                 types::FrameReport& report) override;
};

/// Whoever asks where the robot is gets an answer for every image.
class EverySelect final : public SelectStep {
 public:
  std::optional<Keyframe> select(Run& run, Seen seen, const Motion& motion,
                                 types::FrameReport& report) override;
};

}  // namespace engram::pipeline
