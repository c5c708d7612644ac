// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/geometry/stereo_verify.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace engram::geometry {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using types::Matrix6d;
using Matrix36d = Eigen::Matrix<double, 3, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kHuber = 2.5;        // [deviations]
constexpr double kPixelFloor = 1e-6;  // [px]; keeps the covariance of perfect data from being zero
constexpr double kBehind = 1e12;      // squared error of a point that the pose puts behind the camera

/// Image coordinates are (u left, v, u right): their noise is independent.
Vector3d coordinates(const types::StereoPoint& p) { return {p.u, p.v, p.u - p.disparity}; }

Matrix3d projectionJacobian(const Vector3d& p, const types::StereoModel& m) {
  const double s = m.f / p.z(), k = s / p.z();
  Matrix3d J;
  J << s, 0, -k * p.x(), 0, s, -k * p.y(), s, 0, -k * (p.x() - m.baseline);
  return J;
}

Matrix3d triangulationJacobian(const types::StereoPoint& p, const Vector3d& point,
                               const types::StereoModel& m) {
  const double s = point.z() / m.f;
  const Vector3d perDisparity = point / p.disparity;
  Matrix3d J;
  J.col(0) = -perDisparity;
  J(0, 0) += s;
  J.col(1) = Vector3d(0, s, 0);
  J.col(2) = perDisparity;
  return J;
}

/// What does not change while the pose does.
struct Term {
  Vector3d point;     // in a
  Matrix3d toPoint;   // derivative of the point by the coordinates in a
  Vector3d observed;  // coordinates in b
};

std::vector<Term> makeTerms(std::span<const StereoMatch> matches, const types::StereoModel& model) {
  std::vector<Term> terms;
  terms.reserve(matches.size());
  for (const auto& match : matches) {
    const Vector3d point = model.toPoint(match.a);
    terms.push_back({point, triangulationJacobian(match.a, point, model), coordinates(match.b)});
  }
  return terms;
}

/// A residual divided by its deviation for noise of one pixel: whitened by the Cholesky factor of
/// S = I + A A^T, where A takes noise in a to b.
struct Whitened {
  Vector3d residual = Vector3d::Zero();
  Vector3d point = Vector3d::Zero();       // in b
  Matrix3d projection = Matrix3d::Zero();  // whitened derivative by the point in b
  bool visible = false;
};

Whitened whiten(const Term& term, const Isometry3d& T_b_a, const types::StereoModel& model) {
  Whitened out;
  out.point = T_b_a * term.point;
  if (!(out.point.z() > 1e-3)) return out;
  out.visible = true;
  const Matrix3d J = projectionJacobian(out.point, model);
  const Matrix3d A = J * T_b_a.linear() * term.toPoint;
  Matrix3d S = A * A.transpose();
  S.diagonal().array() += 1;
  const Eigen::LLT<Matrix3d> factor(S);
  const types::StereoPoint predicted = model.project(out.point);
  out.residual = factor.matrixL().solve(coordinates(predicted) - term.observed);
  out.projection = factor.matrixL().solve(J);
  return out;
}

/// Huber's cost of a squared error in units of one pixel.
double robust(double squared, double limit) {
  return squared <= limit * limit ? squared : limit * (2 * std::sqrt(squared) - limit);
}

class Minimiser {
 public:
  Minimiser(std::span<const StereoMatch> matches, const types::StereoModel& model)
      : terms_(makeTerms(matches, model)), model_(model) {}

  StereoEstimate run(const Isometry3d& start, int maxIterations);

 private:
  double deviation(const Isometry3d& T_a_b) const;
  double cost(const Isometry3d& T_a_b) const;
  void linearise(const Isometry3d& T_a_b);

  std::vector<Term> terms_;
  types::StereoModel model_;
  double limit_ = 1e9;
  Matrix6d H_ = Matrix6d::Zero();
  Vector6d g_ = Vector6d::Zero();
  double squares_ = 0, weights_ = 0;  // of the last linearisation
};

/// Of the residuals from the median of their squares; that of three degrees of freedom has the median 2.37.
double Minimiser::deviation(const Isometry3d& T_a_b) const {
  const Isometry3d T_b_a = T_a_b.inverse();
  std::vector<double> squares;
  squares.reserve(terms_.size());
  for (const auto& term : terms_) {
    const Whitened w = whiten(term, T_b_a, model_);
    squares.push_back(w.visible ? w.residual.squaredNorm() : kBehind);
  }
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return std::max(kPixelFloor, std::sqrt(*middle / 2.366));
}

double Minimiser::cost(const Isometry3d& T_a_b) const {
  const Isometry3d T_b_a = T_a_b.inverse();
  double sum = 0;
  for (const auto& term : terms_) {
    const Whitened w = whiten(term, T_b_a, model_);
    sum += w.visible ? robust(w.residual.squaredNorm(), limit_) : kBehind;
  }
  return sum;
}

void Minimiser::linearise(const Isometry3d& T_a_b) {
  const Isometry3d T_b_a = T_a_b.inverse();
  H_.setZero();
  g_.setZero();
  squares_ = weights_ = 0;
  for (const auto& term : terms_) {
    const Whitened w = whiten(term, T_b_a, model_);
    if (!w.visible) continue;
    // T_a_b exp(d) moves the point in b by -d_t + [p]x d_r.
    Matrix3d cross;
    cross << 0, -w.point.z(), w.point.y(), w.point.z(), 0, -w.point.x(), -w.point.y(), w.point.x(), 0;
    Matrix36d J;
    J.leftCols<3>() = -w.projection;
    J.rightCols<3>() = w.projection * cross;
    const double norm = w.residual.norm();
    const double weight = norm <= limit_ ? 1 : limit_ / norm;
    H_.noalias() += weight * J.transpose() * J;
    g_.noalias() += weight * J.transpose() * w.residual;
    squares_ += weight * norm * norm;
    weights_ += weight;
  }
}

Isometry3d moved(const Isometry3d& T_a_b, const Vector6d& d) {
  const Vector3d w = d.tail<3>();
  const double angle = w.norm();
  Isometry3d step = Isometry3d::Identity();
  if (angle > 0) step.linear() = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
  step.translation() = d.head<3>();
  return T_a_b * step;
}

StereoEstimate Minimiser::run(const Isometry3d& start, int maxIterations) {
  Isometry3d T = start;
  limit_ = kHuber * std::sqrt(3.0) * deviation(T);
  double current = cost(T), damping = 1e-6;
  linearise(T);
  for (int i = 0; i < maxIterations; ++i) {
    Matrix6d damped = H_;
    damped.diagonal() *= 1 + damping;
    damped.diagonal().array() += 1e-12;
    const Vector6d step = -damped.ldlt().solve(g_);
    const Isometry3d next = moved(T, step);
    const double value = cost(next);
    if (!(value < current)) {
      damping *= 100;
      if (damping > 1e6 || step.norm() < 1e-9) break;
      continue;
    }
    const bool converged = current - value < 1e-5 * current || step.norm() < 1e-7;
    T = next;
    current = value;
    damping = std::max(1e-9, 0.1 * damping);
    linearise(T);
    if (converged) break;
  }
  StereoEstimate out;
  out.T_a_b.T_a_b = T;
  out.sigma = std::max(kPixelFloor, std::sqrt(squares_ / std::max(1.0, 3 * weights_ - 6)));
  H_.diagonal().array() +=
      1e-9;  // directions that no point constrains: a large variance, not an infinite one
  out.T_a_b.cov = out.sigma * out.sigma * H_.inverse();
  return out;
}

}  // namespace

StereoEstimate refineStereo(std::span<const StereoMatch> matches, const types::StereoModel& model,
                            const Isometry3d& start, int maxIterations) {
  if (matches.empty()) return {{.T_a_b = start}, 0};
  return Minimiser(matches, model).run(start, maxIterations);
}

}  // namespace engram::geometry
