// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/bags/bag_source.h"
#include "engram/sources/odometry_track.h"
#include "ros_messages.h"

#include <map>

namespace engram::bags {

/// Odometry of a whole bag.
class BagOdometry {
 public:
  void add(double stamp, const Eigen::Isometry3d& T_odom_robot) {
    samples_.push_back({stamp, types::toPose2(T_odom_robot)});
  }
  /// To be called after the last add().
  void sort();
  bool empty() const { return samples_.empty(); }
  std::size_t size() const { return samples_.size(); }
  /// Interpolated between neighbours that are at most a second apart; held for 0.2 s at a gap.
  std::optional<Eigen::Isometry3d> at(double stamp) const;

 private:
  struct Sample {
    double stamp;
    sources::Pose2 pose;
  };
  std::vector<Sample> samples_;
};

/// All of a bag but the pixels.
struct BagScan {
  std::vector<BagTopic> topics;
  std::map<std::string, RosCameraInfo> calibrations;  ///< the first of each topic
  std::map<std::string, std::string> imageFrames;     ///< frame of the camera, by topic of its images
  std::map<std::string, RosPose> parents;             ///< first transform of each frame, by child
  std::map<std::string, BagOdometry> odometry;        ///< by topic; of transforms: "tf CHILD"
  std::map<std::string, std::string> robotFrames;     ///< child of the odometry, by topic
  std::size_t unreadable = 0;                         ///< messages too short for their type

  /// Pose of `frame` on `base`; none where no transforms join them.
  std::optional<Eigen::Isometry3d> mount(const std::string& base, const std::string& frame) const;
};

BagScan scanBag(const std::string& path);

}  // namespace engram::bags
