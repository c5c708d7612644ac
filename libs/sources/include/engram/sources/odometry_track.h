// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include <deque>
#include <optional>

namespace engram::sources {

/// A pose in the plane: position [m] and heading [rad].
struct Pose2 {
  double x = 0.0, y = 0.0, yaw = 0.0;
};

/// a then b: b is given in the frame of a.
Pose2 compose(const Pose2& a, const Pose2& b);
/// Where b is, seen from a.
Pose2 between(const Pose2& a, const Pose2& b);
/// Share s of the way from a to b along the circular arc that joins them (constant twist: exp(s log(a^-1 b))
/// in SE(2)).
Pose2 interpolate(const Pose2& a, const Pose2& b, double s);

Eigen::Isometry3d toIsometry(const Pose2& pose);
/// The part of a 3D pose that lies in the plane: x, y and the heading of its x axis.
Pose2 toPose2(const Eigen::Isometry3d& pose);

/// The last samples of wheel odometry, to be asked for the pose at the stamp of an image.
class OdometryTrack {
 public:
  /// Stamps [s] must rise.
  void add(double stamp, const Pose2& pose);
  void clear() { samples_.clear(); }
  bool empty() const { return samples_.empty(); }

  /// True when no later sample can change the answer of at(stamp).
  bool covers(double stamp) const { return !samples_.empty() && samples_.back().stamp >= stamp; }

  /// The pose at `stamp`: interpolated between its neighbours; before the first and after the last sample
  /// that sample is held for `hold` seconds, and then there is none.
  std::optional<Pose2> at(double stamp, double hold) const;

 private:
  struct Sample {
    double stamp;
    Pose2 pose;
  };
  static constexpr std::size_t kMaxSamples =
      4096;  // constant memory; 40 s at 100 Hz is far more than images lag
  std::deque<Sample> samples_;
};

}  // namespace engram::sources
