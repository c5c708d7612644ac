// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/drift.h"

#include <Eigen/SVD>

namespace engram::evaluation {
namespace {

using Eigen::Isometry3d;

/// A piece with its truth.
struct Track {
  std::vector<Isometry3d> estimate, truth;
  std::vector<double> travelled;  // along the true path [m]
};

Track associate(std::span<const StampedPose> piece, std::span<const StampedPose> truth, double maxGap) {
  Track track;
  for (const auto& pose : piece) {
    const auto at = poseAt(truth, pose.stamp, maxGap);
    if (!at) continue;
    const double step =
        track.truth.empty() ? 0 : (at->translation() - track.truth.back().translation()).norm();
    track.travelled.push_back((track.travelled.empty() ? 0 : track.travelled.back()) + step);
    track.truth.push_back(*at);
    track.estimate.push_back(pose.T_world_body);
  }
  return track;
}

/// Adds the errors of a track to the sums.
void measure(const Track& track, StretchError& sum) {
  std::size_t j = 0;
  for (std::size_t i = 0; i < track.truth.size(); ++i) {
    while (j < track.truth.size() && track.travelled[j] - track.travelled[i] < sum.length) ++j;
    if (j == track.truth.size()) return;
    const Isometry3d is = track.estimate[i].inverse() * track.estimate[j];
    const Isometry3d was = track.truth[i].inverse() * track.truth[j];
    const Isometry3d error = was.inverse() * is;
    const double length = track.travelled[j] - track.travelled[i];
    sum.translation += error.translation().norm() / length;
    sum.rotation += Eigen::AngleAxisd(error.linear()).angle() / length;
    ++sum.stretches;
  }
}

void divide(StretchError& sum) {
  if (sum.stretches == 0) return;
  sum.translation /= sum.stretches;
  sum.rotation /= sum.stretches;
}

}  // namespace

Drift drift(std::span<const Trajectory> pieces, std::span<const StampedPose> truth,
            std::span<const double> lengths, double maxGap) {
  std::vector<Track> tracks;
  Drift out;
  for (const auto& piece : pieces) {
    tracks.push_back(associate(piece, truth, maxGap));
    if (!tracks.back().travelled.empty()) out.all.length += tracks.back().travelled.back();
  }
  for (const double length : lengths) {
    StretchError sum{.length = length};
    for (const auto& track : tracks) measure(track, sum);
    out.all.stretches += sum.stretches;
    out.all.translation += sum.translation;
    out.all.rotation += sum.rotation;
    divide(sum);
    if (sum.stretches > 0) out.byLength.push_back(sum);
  }
  divide(out.all);
  return out;
}

std::optional<Eigen::Matrix3d> fitBody(std::span<const Trajectory> pieces, std::span<const StampedPose> truth,
                                       double maxGap) {
  constexpr double kVaried = 0.05;  // share of the motion that must go another way
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const auto& piece : pieces) {
    const Track track = associate(piece, truth, maxGap);
    for (std::size_t i = 1; i < track.truth.size(); ++i) {
      const Eigen::Vector3d was = (track.truth[i - 1].inverse() * track.truth[i]).translation();
      const Eigen::Vector3d is = (track.estimate[i - 1].inverse() * track.estimate[i]).translation();
      sum += was * is.transpose();
    }
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[1] > kVaried * svd.singularValues()[0])) return std::nullopt;
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant();
  return svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

Trajectory turnBody(std::span<const StampedPose> trajectory, const Eigen::Matrix3d& R_body_other) {
  Trajectory out(trajectory.begin(), trajectory.end());
  for (auto& pose : out) pose.T_world_body.linear() = pose.T_world_body.linear() * R_body_other;
  return out;
}

}  // namespace engram::evaluation
