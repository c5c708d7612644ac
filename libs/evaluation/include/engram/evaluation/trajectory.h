// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace engram::evaluation {

struct StampedPose {
  double stamp = 0.0;  ///< [s]
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();
};

/// Poses with strictly increasing stamps.
using Trajectory = std::vector<StampedPose>;

/// A TUM file: `stamp x y z qx qy qz qw` a line, `#` comments. Throws base::Error with file and line for
/// anything else, for quaternions that are not of unit length and for stamps that do not increase.
Trajectory readTum(const std::string& path);
Trajectory parseTum(const std::string& text, const std::string& name);

/// Poses as data sets ship them, told by the fields of a line: TUM; EuRoC's csv (`ns,x,y,z,qw,qx,qy,qz,…`);
/// KITTI's matrices of 3 x 4 or 4 x 4 numbers, with the stamps of `times.txt` beside the file or, without it,
/// one second apart from 0, as images without stamps are. Throws base::Error as readTum().
Trajectory readPoses(const std::string& path);
/// @param name the path, for messages and to find `times.txt`
Trajectory parsePoses(const std::string& text, const std::string& name);
/// Whether a line is a pose in one of these forms.
bool isPoseLine(const std::string& line);

/// Writes what readTum() reads, with all digits that matter.
void writeTum(std::ostream& out, std::span<const StampedPose> trajectory);

/// The pose at a stamp: linear in position, slerp in rotation. None outside of the trajectory or in a gap of
/// more than `maxGap` seconds between poses; a stamp within a millisecond of a pose is that pose.
std::optional<Eigen::Isometry3d> poseAt(std::span<const StampedPose> trajectory, double stamp,
                                        double maxGap = 1.0);

}  // namespace engram::evaluation
