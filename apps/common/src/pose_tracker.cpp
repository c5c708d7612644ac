// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/pose_tracker.h"

namespace engram::apps {

void PoseTracker::update(const std::optional<Eigen::Isometry3d>& fix,
                         const std::optional<Eigen::Isometry3d>& T_odom_robot) {
  if (fix)
    T_map_robot_ = fix;
  else if (T_map_robot_ && T_odom_last_ && T_odom_robot)
    *T_map_robot_ = *T_map_robot_ * (T_odom_last_->inverse() * *T_odom_robot);
  else
    T_map_robot_.reset();
  T_odom_last_ = T_odom_robot;
}

}  // namespace engram::apps
