// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "perceive_steps.h"

#include "engram/features/matching.h"
#include "engram/geometry/verify.h"
#include "engram/types/se3.h"
#include "step_timer.h"

#include <cmath>
#include <utility>

namespace engram::pipeline {
namespace {

constexpr double kStill = 1e-4;     // [m] and [rad]
constexpr int kDead = 2;            // images that move while the wheels stand: these are dead
constexpr double kSeenTurn = 0.05;  // [rad] between images of a robot that has moved

/// What two images say of the motion between them.
enum class Sight { kMoved, kStood, kUnknown };

/// Someone may stand before the robot: then geometry cannot tell.
Sight motionSeen(const types::Features& now, const types::Features& then,
                 std::span<const types::Match> matches, const geometry::VerifyParams& params) {
  if (now.bearings.empty() || then.bearings.empty()) return Sight::kUnknown;
  const auto v = geometry::verify(now, then, matches, Eigen::Vector3d::UnitZ(), params);
  if (!v.ok()) return Sight::kUnknown;
  const Eigen::Isometry3d& T = v.T_a_b.T_a_b;
  const bool moved = !T.translation().isZero() || std::abs(Eigen::AngleAxisd(T.linear()).angle()) > kSeenTurn;
  if (moved) return Sight::kMoved;
  const double same = similarity(static_cast<int>(v.inliers.size()), static_cast<int>(then.size()));
  return same >= kSameSpot ? Sight::kStood : Sight::kUnknown;
}

/// The image is taken up; the wheels count on from here.
Keyframe takenUp(Run& run, Seen seen) {
  const double distance = run.robot.sinceKeyframe().distance();
  const cv::Mat picture = seen.pair.left.empty() ? seen.frame.image : seen.pair.left;
  return {seen.frame, std::move(seen.features), picture, run.robot.markKeyframe(), distance};
}

}  // namespace

std::optional<Seen> FeaturesStep::perceive(Run& run, const types::Frame& frame, types::FrameReport& report) {
  auto features = run.perception.look(frame, run.params.recognise.accept_inliers, report);
  if (!features) return std::nullopt;
  return Seen{frame, std::move(*features), {}};
}

std::optional<Seen> PairStep::perceive(Run& run, const types::Frame& frame, types::FrameReport& report) {
  const StepTimer timer(report, "perceive");
  report.outcome = types::Outcome::kUnusable;
  report.reason = run.perception.refusal(frame);
  if (!report.reason.empty()) return std::nullopt;
  return Seen{frame, {}, run.perception.lookWithBothEyes(frame)};
}

std::optional<Motion> WheelsStep::move(Run& run, const Seen& seen, types::FrameReport&) {
  run.robot.turn(seen.frame.T_odom_robot, seen.frame.stamp);
  return Motion{};
}

EyesStep::EyesStep(const Run& run)
    : odometry_(run.perception.stereo()->model, run.perception.rectifiedMask(), run.params.visual_odometry) {}

std::optional<Motion> EyesStep::move(Run& run, const Seen& seen, types::FrameReport& report) {
  const StepTimer timer(report, "move");
  const bool sound = run.robot.turn(seen.frame.T_odom_robot, seen.frame.stamp);
  const auto byWheels = eyeStep(run, seen.frame);
  const odometry::OdometryResult found = odometry_.process(seen.pair, sound ? byWheels : std::nullopt);
  report.features = found.points;
  if (!found.ok()) {
    run.robot.lose();
    if (found.reason == odometry::OdometryReason::kFirst) report.outcome = types::Outcome::kSkipped;
    report.reason = whyLost(run, found.reason);
    return std::nullopt;
  }
  if (!run.robot.lost())
    return follow(run, seen, found, report) ? std::optional(Motion{found.newKeyframe}) : std::nullopt;
  odometry_.reset();
  return Motion{odometry_.process(seen.pair).newKeyframe};
}

/// The robot is where its eyes say, unless that is farther than it can have come.
bool EyesStep::follow(Run& run, const Seen& seen, const odometry::OdometryResult& found,
                      types::FrameReport& report) {
  const auto T_anchor_robot =
      types::compose(run.robot.anchorToKeyframe(), run.perception.stereo()->ofRobot(found.T_keyframe_now));
  const double stamp = seen.frame.stamp;
  const double moved = (run.robot.lastSeen().T_a_b.inverse() * T_anchor_robot.T_a_b).translation().norm();
  if (moved > run.params.views.max_speed * std::max(0.1, std::abs(stamp - run.robot.seenStamp()))) {
    run.robot.lose();
    odometry_.reset();
    report.reason = "visual odometry failed: it says that the robot is faster than it can be";
    return false;
  }
  run.robot.see(T_anchor_robot, stamp, found.newKeyframe);
  return true;
}

/// The motion of the left eye since the last image by the wheels: it tells odometry where to look.
std::optional<Eigen::Isometry3d> EyesStep::eyeStep(const Run& run, const types::Frame& frame) {
  const auto last = std::exchange(T_odom_last_, frame.T_odom_robot);
  if (!last || !frame.T_odom_robot) return std::nullopt;
  const Eigen::Isometry3d& T_robot_eye = run.perception.stereo()->T_robot_cam;
  return T_robot_eye.inverse() * last->inverse() * *frame.T_odom_robot * T_robot_eye;
}

std::string EyesStep::whyLost(const Run& run, odometry::OdometryReason reason) {
  if (reason == odometry::OdometryReason::kFirst) return "the first image";
  std::string why = std::string("visual odometry failed: ") + odometry::toString(reason);
  const odometry::StereoHealth health = *run.perception.eyes();
  if (!health.ok() && health.fault != odometry::StereoFault::kUnknown)
    why += "; " + odometry::describe(health);
  return why;
}

std::optional<Keyframe> MotionSelect::select(Run& run, Seen seen, const Motion&, types::FrameReport& report) {
  const StepTimer timer(report, "select");
  if (standing(run, seen, report)) {
    report.outcome = types::Outcome::kSkipped;
    return std::nullopt;
  }
  last_ = seen.features;
  return takenUp(run, std::move(seen));
}

/// An encoder that has died says for good that the robot stands. The images know better.
bool MotionSelect::wheelsDead(Run& run, const Seen& seen) {
  const DeadReckoning& way = run.robot.sinceKeyframe();
  if (way.distance() > kStill || way.rotation() > kStill) {
    moved_ = 0;
    return false;
  }
  const auto matches = features::match(seen.features, last_, run.params.match);
  moved_ += motionSeen(seen.features, last_, matches, run.params.verify) == Sight::kMoved;
  if (moved_ < kDead) return false;
  run.robot.wheelsFailed();
  return true;
}

/// A-05 asks the image beside the wheels.
bool MotionSelect::tooSimilar(const Run& run, const Seen& seen, types::FrameReport& report) const {
  if (run.params.select.max_similarity >= 1) return false;
  if (likeness(run, seen) <= run.params.select.max_similarity) return false;
  report.reason = "the image is too similar to the last one";
  return true;
}

double MotionSelect::likeness(const Run& run, const Seen& seen) const {
  const auto matches = features::match(seen.features, last_, run.params.match);
  return similarity(static_cast<int>(matches.size()), static_cast<int>(last_.size()));
}

bool MotionSelect::standing(Run& run, const Seen& seen, types::FrameReport& report) {
  if (last_.empty()) return false;
  const DeadReckoning& way = run.robot.sinceKeyframe();
  if (way.known() && !wheelsDead(run, seen)) {
    if (way.distance() >= run.params.select.min_distance || way.rotation() >= run.params.select.min_rotation)
      return tooSimilar(run, seen, report);
    report.reason = "the robot has not moved";
    return true;
  }
  const auto matches = features::match(seen.features, last_, run.params.match);
  const double s = similarity(static_cast<int>(matches.size()), static_cast<int>(last_.size()));
  const bool stands = s >= run.params.select.standing_similarity ||
                      motionSeen(seen.features, last_, matches, run.params.verify) == Sight::kStood;
  if (stands) report.reason = "the image is nearly the last one";
  return stands;
}

std::optional<Keyframe> KeyframeSelect::select(Run& run, Seen seen, const Motion& motion,
                                               types::FrameReport& report) {
  const StepTimer timer(report, "select");
  report.outcome = types::Outcome::kSkipped;
  const double since = seen.frame.stamp - run.robot.anchorStamp();
  const bool soon = !run.robot.lost() && since >= 0 && since < run.params.views.min_interval;
  if (!motion.keyframe || soon) {
    if (!run.robot.lost())
      report.reason = motion.keyframe ? "a view was taken shortly before" : "the robot has not moved";
    return std::nullopt;
  }
  seen.features = viewFeatures(run.perception, seen.pair, run.params.views.max_features);
  report.features = static_cast<int>(seen.features.size());
  if (report.features >= run.params.stereo.min_inliers) return takenUp(run, std::move(seen));
  report.reason = "too few features whose range is known";
  return std::nullopt;
}

std::optional<Keyframe> EverySelect::select(Run& run, Seen seen, const Motion&, types::FrameReport&) {
  return takenUp(run, std::move(seen));
}

}  // namespace engram::pipeline
