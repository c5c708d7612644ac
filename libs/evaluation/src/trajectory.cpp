// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/trajectory.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>

namespace engram::evaluation {
namespace {

constexpr double kSameStamp = 1e-3;

}  // namespace

void writeTum(std::ostream& out, std::span<const StampedPose> trajectory) {
  out << "# stamp x y z qx qy qz qw\n";
  for (const auto& pose : trajectory) {
    const Eigen::Vector3d t = pose.T_world_body.translation();
    const Eigen::Quaterniond q(pose.T_world_body.linear());
    char line[256];
    std::snprintf(line, sizeof line, "%.9f %.9f %.9f %.9f %.12f %.12f %.12f %.12f\n", pose.stamp, t.x(),
                  t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
    out << line;
  }
}

std::optional<Eigen::Isometry3d> poseAt(std::span<const StampedPose> trajectory, double stamp,
                                        double maxGap) {
  const auto earlier = [](const StampedPose& p, double s) { return p.stamp < s; };
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), stamp, earlier);
  if (after != trajectory.end() && after->stamp - stamp <= kSameStamp) return after->T_world_body;
  if (after == trajectory.begin()) return std::nullopt;
  const auto before = after - 1;
  if (stamp - before->stamp <= kSameStamp) return before->T_world_body;
  if (after == trajectory.end() || after->stamp - before->stamp > maxGap) return std::nullopt;
  const double share = (stamp - before->stamp) / (after->stamp - before->stamp);
  const Eigen::Quaterniond from(before->T_world_body.linear()), to(after->T_world_body.linear());
  Eigen::Isometry3d pose;
  pose.linear() = from.slerp(share, to).toRotationMatrix();
  pose.translation() =
      (1 - share) * before->T_world_body.translation() + share * after->T_world_body.translation();
  pose.makeAffine();
  return pose;
}

}  // namespace engram::evaluation
