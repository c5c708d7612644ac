// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "landings.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace engram::pipeline {
namespace {

constexpr double kTurn = 0.15;  // [rad] between where two images put the robot

}  // namespace

bool Landings::agree(std::uint64_t image, const Eigen::Isometry3d& T_map_robot,
                     const Eigen::Isometry3d& T_own_robot, double within) {
  if (image != image_) before_ = std::exchange(now_, {});
  image_ = image;
  now_.push_back({T_map_robot, T_own_robot});
  return std::any_of(before_.begin(), before_.end(), [&](const Landing& earlier) {
    const Eigen::Isometry3d way = earlier.T_own_robot.inverse() * T_own_robot;
    const Eigen::Isometry3d gap = (earlier.T_map_robot * way).inverse() * T_map_robot;
    return gap.translation().norm() < within && std::abs(Eigen::AngleAxisd(gap.linear()).angle()) < kTurn;
  });
}

}  // namespace engram::pipeline
