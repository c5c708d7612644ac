// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/trajectory_error.h"

#include <Eigen/Dense>

#include <cmath>
#include <stdexcept>

namespace engram::evaluation {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3Xd;

struct Pairs {
  std::vector<Isometry3d> estimate, truth;
};

Pairs associate(std::span<const StampedPose> estimate, std::span<const StampedPose> truth, double maxGap) {
  Pairs pairs;
  for (const auto& pose : estimate) {
    const auto at = poseAt(truth, pose.stamp, maxGap);
    if (!at) continue;
    pairs.estimate.push_back(pose.T_world_body);
    pairs.truth.push_back(*at);
  }
  return pairs;
}

Matrix3Xd positions(const std::vector<Isometry3d>& poses) {
  Matrix3Xd out(3, static_cast<Eigen::Index>(poses.size()));
  for (std::size_t i = 0; i < poses.size(); ++i)
    out.col(static_cast<Eigen::Index>(i)) = poses[i].translation();
  return out;
}

/// The similarity that takes `from` to `to`, as a 4x4 matrix.
Eigen::Matrix4d fit(const Matrix3Xd& from, const Matrix3Xd& to, Alignment alignment) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  if (alignment == Alignment::kNone) return T;
  const bool onePoint = from.cols() < 2;
  if (onePoint) {
    T.topRightCorner<3, 1>() = to.col(0) - from.col(0);
  } else if (alignment == Alignment::kSe2) {
    // In the plane the optimum has a closed form.
    const Eigen::Vector3d meanFrom = from.rowwise().mean(), meanTo = to.rowwise().mean();
    const Matrix3Xd a = from.colwise() - meanFrom, b = to.colwise() - meanTo;
    const double sine = (a.row(0).array() * b.row(1).array() - a.row(1).array() * b.row(0).array()).sum();
    const double cosine = (a.topRows(2).array() * b.topRows(2).array()).sum();
    T.topLeftCorner<3, 3>() =
        Eigen::AngleAxisd(std::atan2(sine, cosine), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    T.topRightCorner<3, 1>() = meanTo - T.topLeftCorner<3, 3>() * meanFrom;
  } else {
    T = Eigen::umeyama(from, to, alignment == Alignment::kSim3);
  }
  return T;
}

double rmse(const std::vector<double>& values) {
  double squares = 0;
  for (const double v : values) squares += v * v;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace

std::optional<AbsoluteError> ate(std::span<const StampedPose> estimate, std::span<const StampedPose> truth,
                                 Alignment alignment, double maxGap) {
  const Pairs pairs = associate(estimate, truth, maxGap);
  if (pairs.truth.empty()) return std::nullopt;
  const Matrix3Xd from = positions(pairs.estimate), to = positions(pairs.truth);
  const Eigen::Matrix4d T = fit(from, to, alignment);
  AbsoluteError out;
  out.scale = std::cbrt(T.topLeftCorner<3, 3>().determinant());
  out.T_truth_estimate.linear() = T.topLeftCorner<3, 3>() / (out.scale != 0 ? out.scale : 1.0);
  out.T_truth_estimate.translation() = T.topRightCorner<3, 1>();
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < from.cols(); ++i) {
    const Eigen::Vector3d moved = T.topLeftCorner<3, 3>() * from.col(i) + T.topRightCorner<3, 1>();
    distances.push_back((moved - to.col(i)).norm());
  }
  out.rmse = rmse(distances);
  out.distance = percentiles(std::move(distances));
  return out;
}

std::optional<RelativeError> rpe(std::span<const StampedPose> estimate, std::span<const StampedPose> truth,
                                 int step, double maxGap) {
  if (step < 1) throw std::invalid_argument("rpe: the step must be at least 1");
  const Pairs pairs = associate(estimate, truth, maxGap);
  std::vector<double> translations, rotations;
  for (std::size_t i = 0; i + static_cast<std::size_t>(step) < pairs.truth.size(); ++i) {
    const std::size_t j = i + static_cast<std::size_t>(step);
    const Isometry3d is = pairs.estimate[i].inverse() * pairs.estimate[j];
    const Isometry3d was = pairs.truth[i].inverse() * pairs.truth[j];
    const Isometry3d error = was.inverse() * is;
    translations.push_back(error.translation().norm());
    rotations.push_back(Eigen::AngleAxisd(error.linear()).angle());
  }
  if (translations.empty()) return std::nullopt;
  RelativeError out;
  out.translationRmse = rmse(translations);
  out.rotationRmse = rmse(rotations);
  out.translation = percentiles(std::move(translations));
  out.rotation = percentiles(std::move(rotations));
  return out;
}

}  // namespace engram::evaluation
