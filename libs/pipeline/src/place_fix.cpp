// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/place_fix.h"

#include "engram/types/se3.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace engram::pipeline {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using types::Matrix6d;

constexpr double kCentreSigma = 0.05;     // [m]: a place has learnt its features from more than one point
constexpr double kNoParallaxSigma = 0.1;  // [m]: so near to the place geometry sees no translation
constexpr double kWrong = 0.05;           // share of directions that are wrong, and may be any
constexpr double kGate = 16.27;           // chi-square: 99.9 % of the true ones, three degrees of freedom
constexpr double kPoseGate = 22.46;       // six

constexpr int kPoints = 16;       // of the grid, to either side of its middle
constexpr double kHalfWidth = 3;  // of the grid, in deviations
constexpr int kRounds = 4;        // of the grid: each lies over what the one before found

/// Position of the robot in the frame of the place.
struct Position {
  Vector3d mean;
  Matrix3d cov;
};

/// Density of the measured direction for a robot at this position, on the circle about the place.
double likelihood(const Vector3d& eye, const Vector3d& direction, double sigmaDirection) {
  const double distance = eye.norm();
  const double sigma = std::hypot(sigmaDirection, kCentreSigma / std::max(distance, 1e-9));
  const double off = std::atan2(eye.cross(direction).norm(), eye.dot(direction)) / sigma;
  const double width = std::sqrt(2 * std::numbers::pi) * std::min(sigma, std::sqrt(2 * std::numbers::pi));
  return (1 - kWrong) * std::exp(-0.5 * off * off) / width + kWrong / (2 * std::numbers::pi);
}

/// Moments of the posterior, on a grid over the two axes that are least known: a robot stands on a floor.
/// @param offset from the robot to its camera, in the frame of the place
Position posterior(const Position& prior, const Vector3d& offset, const PlaceMatch& match) {
  const Eigen::LLT<Matrix3d> information(prior.cov);
  Position found = prior;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(found.cov);  // the best known axis first
    const Eigen::Matrix<double, 3, 2> width =
        kHalfWidth * axes.eigenvectors().rightCols<2>() *
        axes.eigenvalues().tail<2>().cwiseMax(0).cwiseSqrt().asDiagonal();
    double sum = 0;
    Vector3d first = Vector3d::Zero();
    Matrix3d second = Matrix3d::Zero();
    for (int i = -kPoints; i <= kPoints; ++i)
      for (int j = -kPoints; j <= kPoints; ++j) {
        const Vector3d step = width * Eigen::Vector2d(i, j) / kPoints;
        const Vector3d p = found.mean + step;
        const Vector3d z = information.matrixL().solve(p - prior.mean);
        const double weight = std::exp(-0.5 * z.squaredNorm()) *
                              likelihood(p + offset, match.direction_place, match.sigmaDirection);
        sum += weight;
        first += weight * step;
        second += weight * step * step.transpose();
      }
    if (!(sum > 0)) return prior;
    first /= sum;
    const Vector3d flat = axes.eigenvectors().col(0);
    found = {found.mean + first,
             second / sum - first * first.transpose() + axes.eigenvalues()[0] * flat * flat.transpose()};
  }
  return found;
}

Matrix3d rotationCovariance(const PlaceMatch& match) {
  return Matrix3d::Identity() * match.sigmaRotation * match.sigmaRotation;
}

/// The rotation is linear: a Kalman update. False when it contradicts what was expected.
bool turn(types::RelPose& pose, const PlaceMatch& match) {
  const Eigen::AngleAxisd off(Matrix3d(pose.T_a_b.linear().transpose() * match.R_place_view));
  const Vector3d innovation = off.angle() * off.axis();
  const Matrix3d S = pose.cov.bottomRightCorner<3, 3>() + rotationCovariance(match);
  const Eigen::LLT<Matrix3d> llt(S);
  if (innovation.dot(llt.solve(innovation)) > kGate) return false;
  const Eigen::Matrix<double, 6, 3> gain = llt.solve(pose.cov.bottomRows<3>()).transpose();
  pose.cov = types::symmetric(pose.cov - gain * S * gain.transpose());
  pose.T_a_b = pose.T_a_b * types::expSe3(gain * innovation);
  return true;
}

/// What contradicts a pose makes it less certain: when it is wrong, what is measured next may put it right.
types::RelPose doubted(types::RelPose pose) {
  pose.cov *= 4;
  return pose;
}

/// Two independent estimates of one pose; none when they contradict each other.
std::optional<types::RelPose> fused(const types::RelPose& expected, const types::RelPose& measured) {
  const types::Vector6d innovation = types::logSe3(expected.T_a_b.inverse() * measured.T_a_b);
  const Matrix6d S = expected.cov + measured.cov;
  const Eigen::LLT<Matrix6d> llt(S);
  if (innovation.dot(llt.solve(innovation)) > kPoseGate) return std::nullopt;
  const Matrix6d gain = llt.solve(expected.cov).transpose();
  return types::RelPose{.T_a_b = types::rigid(expected.T_a_b * types::expSe3(gain * innovation)),
                        .cov = types::symmetric(expected.cov - gain * S * gain.transpose())};
}

}  // namespace

std::optional<types::RelPose> measuredBy(const PlaceMatch& match, const Eigen::Vector3d& eye) {
  const bool atPlace = match.direction_place.isZero();
  if (!match.length && !atPlace) return std::nullopt;
  const Length length = atPlace ? Length{0, kNoParallaxSigma} : *match.length;
  const Matrix3d& R = match.R_place_view;
  types::RelPose pose;
  pose.T_a_b.linear() = R;
  // The place remembers what the camera saw there, not the robot.
  pose.T_a_b.translation() = length.metres * match.direction_place - (R * eye - eye);
  const double along = std::hypot(length.sigma, kCentreSigma);
  const double across = atPlace ? along : std::hypot(match.sigmaDirection * length.metres, kCentreSigma);
  const Matrix3d outer = match.direction_place * match.direction_place.transpose();
  const Matrix3d cov = across * across * (Matrix3d::Identity() - outer) + along * along * outer;
  pose.cov.setZero();
  pose.cov.topLeftCorner<3, 3>() = R.transpose() * cov * R;
  pose.cov.bottomRightCorner<3, 3>() = rotationCovariance(match);
  pose.cov = types::symmetric(pose.cov);
  return pose;
}

bool agrees(const PlaceMatch& match, const types::RelPose& expected, const Eigen::Vector3d& eye) {
  if (const auto measured = measuredBy(match, eye)) return fused(expected, *measured).has_value();
  types::RelPose pose = expected;
  return turn(pose, match);
}

types::RelPose correctedBy(const PlaceMatch& match, const types::RelPose& expected,
                           const Eigen::Vector3d& eye) {
  if (const auto measured = measuredBy(match, eye))
    return fused(expected, *measured).value_or(doubted(expected));
  types::RelPose pose = expected;
  if (!turn(pose, match)) return doubted(expected);
  const Matrix3d R = pose.T_a_b.linear(), within = pose.cov.topLeftCorner<3, 3>();
  const Position now =
      posterior({pose.T_a_b.translation(), R * within * R.transpose()}, R * eye - eye, match);
  // The rest follows the position as far as it hangs on it.
  const Eigen::Matrix<double, 6, 3> gain = within.llt().solve(pose.cov.topRows<3>()).transpose();
  pose.cov = types::symmetric(pose.cov + gain * (R.transpose() * now.cov * R - within) * gain.transpose());
  pose.T_a_b = pose.T_a_b * types::expSe3(gain * R.transpose() * (now.mean - pose.T_a_b.translation()));
  pose.T_a_b = types::rigid(pose.T_a_b);
  return pose;
}

}  // namespace engram::pipeline
