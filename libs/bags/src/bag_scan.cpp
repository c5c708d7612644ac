// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_scan.h"

#include "engram/base/error.h"

#include <algorithm>

namespace engram::bags {
namespace {

constexpr double kLongestStep = 1.0;  // between two readings of odometry [s]
constexpr double kHold = 0.2;         // beyond a reading [s]
constexpr int kDeepestTree = 100;     // of transforms

double stampOf(const RosHeader& header, const BagMessage& message) {
  return header.stamp > 0 ? header.stamp : 1e-9 * static_cast<double>(message.received);
}

void scanMessage(const BagMessage& message, const BagTopic& topic, BagScan& scan) {
  if (isImageType(topic.type)) {
    if (!scan.imageFrames.contains(topic.name))
      scan.imageFrames[topic.name] = readHeader(message, topic).frame;
  } else if (topic.type == "sensor_msgs/CameraInfo") {
    if (!scan.calibrations.contains(topic.name))
      scan.calibrations[topic.name] = readCameraInfo(message, topic);
  } else if (topic.type == "nav_msgs/Odometry") {
    const RosPose pose = readOdometry(message, topic);
    scan.odometry[topic.name].add(stampOf(pose.header, message), pose.T_frame_child);
    scan.robotFrames.emplace(topic.name, pose.child);
  } else if (isTransformType(topic.type)) {
    for (const RosPose& pose : readTransforms(message, topic)) {
      scan.parents.emplace(pose.child, pose);
      if (pose.header.frame == "odom")
        scan.odometry["tf " + pose.child].add(stampOf(pose.header, message), pose.T_frame_child);
    }
  }
}

}  // namespace

void BagOdometry::sort() {
  std::stable_sort(samples_.begin(), samples_.end(),
                   [](const Sample& a, const Sample& b) { return a.stamp < b.stamp; });
}

std::optional<Eigen::Isometry3d> BagOdometry::at(double stamp) const {
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), stamp,
                                      [](const Sample& sample, double t) { return sample.stamp < t; });
  const bool hasAfter = after != samples_.end(), hasBefore = after != samples_.begin();
  if (hasAfter && after->stamp == stamp) return types::toIsometry(after->pose);
  if (hasAfter && hasBefore && after->stamp - (after - 1)->stamp <= kLongestStep) {
    const Sample& before = *(after - 1);
    const double share = (stamp - before.stamp) / (after->stamp - before.stamp);
    return types::toIsometry(types::interpolate(before.pose, after->pose, share));
  }
  if (hasBefore && stamp - (after - 1)->stamp <= kHold) return types::toIsometry((after - 1)->pose);
  if (hasAfter && after->stamp - stamp <= kHold) return types::toIsometry(after->pose);
  return std::nullopt;
}

std::optional<Eigen::Isometry3d> BagScan::mount(const std::string& base, const std::string& frame) const {
  // Both chains up to their roots: the robot's frame need not lie above the camera's.
  const auto chain = [this](std::string at) {
    std::map<std::string, Eigen::Isometry3d> T_ancestor_start{{at, Eigen::Isometry3d::Identity()}};
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    for (int depth = 0; depth < kDeepestTree && parents.contains(at); ++depth) {
      const RosPose& up = parents.at(at);
      T = up.T_frame_child * T;
      at = up.header.frame;
      if (!T_ancestor_start.emplace(at, T).second) break;
    }
    return T_ancestor_start;
  };
  const auto ofBase = chain(base), ofFrame = chain(frame);
  // An ancestor in which the robot moves joins nothing.
  if (const auto found = ofFrame.find(base); found != ofFrame.end()) return found->second;
  for (const auto& [ancestor, T_ancestor_base] : ofBase)
    if (const auto found = ofFrame.find(ancestor);
        found != ofFrame.end() && ancestor != "odom" && ancestor != "map")
      return T_ancestor_base.inverse() * found->second;
  return std::nullopt;
}

BagScan scanBag(const std::string& path) {
  BagScan scan;
  const auto reader = openBag(path);
  while (const auto message = reader->next()) {
    try {
      scanMessage(*message, reader->topics()[message->topic], scan);
    } catch (const base::Error&) {
      ++scan.unreadable;
    }
  }
  scan.topics = reader->topics();
  for (auto& [topic, odometry] : scan.odometry) odometry.sort();
  return scan;
}

}  // namespace engram::bags
