// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/trajectory.h"

#include "engram/base/text_file.h"
#include "text_lines.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>

namespace engram::evaluation {
namespace {

/// Quaternions are written with some six digits.
constexpr double kUnitTolerance = 1e-2;
constexpr double kSameStamp = 1e-3;

StampedPose parsePose(const TextLine& line) {
  const auto fields = splitFields(line.text, ' ');
  if (fields.size() != 8)
    refuse(line.origin,
           "expected 8 numbers (stamp x y z qx qy qz qw), found " + std::to_string(fields.size()));
  double v[8];
  const char* names[8] = {"stamp", "x", "y", "z", "qx", "qy", "qz", "qw"};
  for (std::size_t i = 0; i < 8; ++i) v[i] = parseReal(fields[i], line.origin, names[i]);
  const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
  if (std::abs(q.norm() - 1.0) > kUnitTolerance) refuse(line.origin, "the quaternion is not of unit length");
  StampedPose pose;
  pose.stamp = v[0];
  pose.T_world_body.linear() = q.normalized().toRotationMatrix();
  pose.T_world_body.translation() << v[1], v[2], v[3];
  return pose;
}

}  // namespace

Trajectory parseTum(const std::string& text, const std::string& name) {
  Trajectory trajectory;
  for (const auto& line : contentLines(text, name)) {
    trajectory.push_back(parsePose(line));
    const std::size_t n = trajectory.size();
    if (n > 1 && !(trajectory[n - 1].stamp > trajectory[n - 2].stamp))
      refuse(line.origin, "the stamp is not later than the one before");
  }
  if (trajectory.empty()) refuse(name, "holds no poses");
  return trajectory;
}

Trajectory readTum(const std::string& path) { return parseTum(base::readTextFile(path), path); }

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
