// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "whereabouts.h"

#include <algorithm>

namespace engram::pipeline {

bool Whereabouts::turn(const std::optional<Eigen::Isometry3d>& T_odom_robot, double stamp) {
  T_odom_robot_ = T_odom_robot;
  if (T_odom_robot && watch_.leaps(*T_odom_robot, stamp)) {
    stray();
    return false;
  }
  for (DeadReckoning* way : {&wheels_, &sinceMade_, &sinceMark_}) way->move(T_odom_robot);
  return true;
}

void Whereabouts::wheelsFailed() {
  watch_.frozen();
  stray();
}

void Whereabouts::stray() {
  strayed_ = true;
  for (DeadReckoning* way : {&wheels_, &sinceMade_, &sinceMark_})
    if (T_odom_robot_) way->leap(*T_odom_robot_);
}

void Whereabouts::see(const types::RelPose& T_anchor_robot, double stamp, bool keyframe) {
  T_anchor_robot_ = T_anchor_robot;
  seenStamp_ = stamp;
  if (keyframe) T_anchor_keyframe_ = T_anchor_robot;
}

std::optional<Travel> Whereabouts::markKeyframe() {
  const auto travel = restarted_ ? std::nullopt : wheels_.travel();
  restarted_ = false;
  sinceAnchor_ += wheels_.distance();
  ++imagesSinceAnchor_;
  wheels_.markKeyframe();
  return travel;
}

std::optional<types::RelPose> Whereabouts::motion() const {
  if (!anchor_.valid()) return std::nullopt;
  if (!lost_) return T_anchor_robot_;
  if (countsWheels_ && wheels_.anchored()) return wheels_.anchorToRobot();
  return std::nullopt;
}

void Whereabouts::made(base::PlaceId place, double stamp, const types::Matrix6d& cov) {
  anchor_ = made_ = place;
  anchoredBy_ = {};
  strayed_ = false;
  anchorStamp_ = seenStamp_ = stamp;
  sinceAnchor_ = 0;
  imagesSinceAnchor_ = 0;
  T_anchor_keyframe_ = T_anchor_robot_ = {.cov = cov};
  wheels_.reset(Eigen::Isometry3d::Identity(), cov);
  sinceMade_.reset(Eigen::Isometry3d::Identity(), cov);
  frontier_ = true;
}

void Whereabouts::backAt(base::PlaceId place, const types::RelPose& T_place_robot, bool agrees) {
  agreeing_ = agrees ? agreeing_ + 1 : 1;
  anchor_ = place;
  strayed_ = false;
  sinceAnchor_ = 0;
  imagesSinceAnchor_ = 0;
  T_anchor_keyframe_ = T_anchor_robot_ = T_place_robot;
  wheels_.reset(T_place_robot.T_a_b, T_place_robot.cov);
  frontier_ = false;
  recent_.clear();
}

void Whereabouts::mark(base::PlaceId place, const types::RelPose& T_place_robot) {
  marked_ = place;
  sinceMark_.reset(T_place_robot.T_a_b, T_place_robot.cov);
}

void Whereabouts::inherit(base::PlaceId heir, const types::RelPose& T_heir_robot) {
  anchor_ = heir;
  T_anchor_keyframe_ = T_anchor_robot_ = T_heir_robot;
  wheels_.reset(T_heir_robot.T_a_b, T_heir_robot.cov);
}

void Whereabouts::restart() {
  anchor_ = marked_ = {};
  agreeing_ = 0;
  restarted_ = true;
}

void Whereabouts::keepRecent(const map::TopologicalMap& map, int hops) {
  recent_.insert(made_);
  const auto near = map.hopDistances(made_, hops);
  std::erase_if(recent_, [&](base::PlaceId id) { return !near.contains(id); });
}

void Whereabouts::deny(const std::vector<base::EdgeId>& closures) {
  const bool denied = std::find(closures.begin(), closures.end(), anchoredBy_) != closures.end();
  if (!denied || !made_.valid()) return;
  anchor_ = made_;
  wheels_ = sinceMade_;
  anchoredBy_ = {};
  frontier_ = true;
}

}  // namespace engram::pipeline
