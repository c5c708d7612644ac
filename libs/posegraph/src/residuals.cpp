// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "residuals.h"

#include "relaxers.h"

#include <Eigen/Cholesky>
#include <ceres/autodiff_cost_function.h>
#include <ceres/jet.h>
#include <ceres/rotation.h>
#include <ceres/sized_cost_function.h>

#include <cmath>
#include <optional>

namespace engram::posegraph {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using types::inverseLeftJacobian;
using types::Matrix6d;
using types::Vector6d;
using Matrix67 = Eigen::Matrix<double, 6, 7, Eigen::RowMajor>;

/// W with W^T W = cov^-1; none when cov is not positive definite.
template <int n>
std::optional<Eigen::Matrix<double, n, n>> whitening(const Eigen::Matrix<double, n, n>& cov) {
  using Matrix = Eigen::Matrix<double, n, n>;
  const Eigen::LLT<Matrix> llt(cov);
  if (llt.info() != Eigen::Success) return std::nullopt;
  return Matrix(llt.matrixL().solve(Matrix::Identity()));
}

Vector3d rotationVector(const Eigen::Quaterniond& q) {
  const double wxyz[4] = {q.w(), q.x(), q.y(), q.z()};
  Vector3d w;
  ceres::QuaternionToAngleAxis(wxyz, w.data());
  return w;
}

/// SE(2) with scale, derivatives by hand.
class PlanarScaled : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  PlanarScaled(const Matrix3d& W, double x, double y, double yaw) : W_(W), x_(x), y_(y), yaw_(yaw) {}

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const double *a = blocks[0], *b = blocks[1];
    const double c = std::cos(a[2] + yaw_), s = std::sin(a[2] + yaw_);
    const double mx = std::cos(yaw_) * x_ + std::sin(yaw_) * y_,
                 my = -std::sin(yaw_) * x_ + std::cos(yaw_) * y_;
    // The gap in the frame where the measurement puts b.
    const double dx = b[0] - a[0], dy = b[1] - a[1];
    const double ex = c * dx + s * dy - mx, ey = -s * dx + c * dy - my;
    const double w = std::remainder(b[2] - a[2] - yaw_, 2 * M_PI), half = w / 2;
    // Inverse of the left Jacobian of SE(2): k = (w / 2) cot(w / 2) and w / 2; slope = dk / dw.
    const bool small = std::abs(half) < 1e-4;
    const double k = small ? 1 - half * half / 3 : half / std::tan(half);
    const double slope =
        small ? -half / 3 : (1 / std::tan(half) - half / (std::sin(half) * std::sin(half))) / 2;
    Eigen::Map<Vector3d>{residuals} = W_ * Vector3d(k * ex + half * ey, k * ey - half * ex, w);
    if (!jacobians) return true;
    Eigen::Matrix2d V, R;  // d(logarithm) / d(gap), d(gap) / d(position of b)
    V << k, half, -half, k;
    R << c, s, -s, c;
    const Eigen::Vector2d byTurn(slope * ex + ey / 2, slope * ey - ex / 2);
    using Map = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
    Matrix3d J = Matrix3d::Zero();
    J.topLeftCorner<2, 2>() = V * R;
    J.topRightCorner<2, 1>() = byTurn;
    J(2, 2) = 1;
    if (jacobians[1]) Map{jacobians[1]} = W_ * J;
    J = -J;
    J.topRightCorner<2, 1>() += V * Eigen::Vector2d(ey + my, -ex - mx);
    if (jacobians[0]) Map{jacobians[0]} = W_ * J;
    return true;
  }

 private:
  Matrix3d W_;
  double x_, y_, yaw_;
};

/// SE(2) without scale.
struct PlanarDirection {
  Eigen::Matrix2d W;
  double dx, dy, yaw;  // d = 0 for a pure rotation: yaw alone

  template <class T>
  bool operator()(const T* a, const T* b, T* out) const {
    const T gx = b[0] - a[0], gy = b[1] - a[1];
    const T n = sqrt(gx * gx + gy * gy + T(1e-12));
    const T ux = (cos(a[2]) * gx + sin(a[2]) * gy) / n, uy = (-sin(a[2]) * gx + cos(a[2]) * gy) / n;
    const T w = b[2] - a[2] - T(yaw);
    Eigen::Map<Eigen::Matrix<T, 3, 1>> r(out);
    r.template head<2>() =
        W.template cast<T>() * Eigen::Matrix<T, 2, 1>(dx * uy - dy * ux, atan2(sin(w), cos(w)));
    r[2] = T(W(0, 0)) * (T(dx * dx + dy * dy) - dx * ux - dy * uy);
    return true;
  }
};

/// SE(3) with scale, derivatives by hand: e = Log(E), E = T_measured^-1 T_a^-1 T_b.
class SpatialScaled : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  explicit SpatialScaled(const types::RelPose& T_a_b)
      : W_(*whitening<6>(T_a_b.cov)),
        adjoint_(adjoint(T_a_b.T_a_b.inverse())),
        t_(T_a_b.T_a_b.translation()),
        q_(Eigen::Quaterniond(T_a_b.T_a_b.linear()).normalized()) {}

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Vector3d> ta(blocks[0]), tb(blocks[1]);
    const Eigen::Map<const Eigen::Quaterniond> qa(blocks[0] + 3), qb(blocks[1] + 3);
    const Vector3d gap = q_.conjugate() * (qa.conjugate() * (tb - ta) - t_);
    const Vector3d w = rotationVector(q_.conjugate() * (qa.conjugate() * qb));
    Vector6d e;
    e << inverseLeftJacobian(w) * gap, w;
    Eigen::Map<Vector6d>{residuals} = W_ * e;
    if (!jacobians) return true;
    for (int end = 0; end < 2; ++end) {
      if (!jacobians[end]) continue;
      Eigen::Map<Matrix67> J(jacobians[end]);
      J.col(6).setZero();
      // Log(E exp(d)) = e + Jr^-1 d with Jr^-1(e) = Jl^-1(-e); exp(-d) of a moves in front of E.
      if (end == 1)
        J.leftCols<6>() = W_ * inverseLeftJacobian(Vector6d(-e));
      else
        J.leftCols<6>() = -W_ * (inverseLeftJacobian(e) * adjoint_);
    }
    return true;
  }

 private:
  Matrix6d W_, adjoint_;
  Vector3d t_;
  Eigen::Quaterniond q_;
};

/// Two unit vectors perpendicular to the unit vector d, as rows.
Eigen::Matrix<double, 2, 3> tangentBasis(const Vector3d& d) {
  const Vector3d u = d.unitOrthogonal();
  Eigen::Matrix<double, 2, 3> B;
  B.row(0) = u;
  B.row(1) = d.cross(u);
  return B;
}

/// SE(3) without scale. Rare, so its derivatives are left to Jets: by the motions of both ends at zero.
class SpatialDirection : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  explicit SpatialDirection(const types::RelPose& T_a_b)
      : q_(Eigen::Quaterniond(T_a_b.T_a_b.linear()).normalized()) {
    const Vector3d t = T_a_b.T_a_b.translation();
    W_.bottomRightCorner<3, 3>() = *whitening<3>(T_a_b.cov.bottomRightCorner<3, 3>());
    if (t.norm() < 1e-6) return;
    Eigen::Matrix<double, 5, 6> J = Eigen::Matrix<double, 5, 6>::Zero();
    const Eigen::Matrix<double, 2, 3> B = tangentBasis(q_.conjugate() * t.normalized());
    J.topLeftCorner<2, 3>() = B;
    J.bottomRightCorner<3, 3>().setIdentity();
    if (const auto W = whitening<5>(J * T_a_b.cov * J.transpose())) {
      W_ = *W;
      B_ = B;
      d_ = t.normalized();
    }
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    using Jet = ceres::Jet<double, 12>;
    Eigen::Matrix<Jet, 3, 1> t[2];
    Eigen::Quaternion<Jet> q[2];
    for (int end = 0; end < 2; ++end) {
      const Eigen::Map<const Vector3d> p(blocks[end]);
      const Eigen::Map<const Eigen::Quaterniond> r(blocks[end] + 3);
      Eigen::Matrix<Jet, 3, 1> d, w;
      for (int i = 0; i < 3; ++i) d[i] = Jet(0, 6 * end + i), w[i] = Jet(0, 6 * end + 3 + i);
      q[end] = r.cast<Jet>() * Eigen::Quaternion<Jet>(Jet(1), w[0] / 2., w[1] / 2., w[2] / 2.);
      t[end] = p.cast<Jet>() + r.cast<Jet>() * d;
    }
    const Eigen::Matrix<Jet, 6, 1> out = residual(t, q);
    for (int i = 0; i < 6; ++i) residuals[i] = out[i].a;
    for (int end = 0; jacobians && end < 2; ++end) {
      if (!jacobians[end]) continue;
      Eigen::Map<Matrix67> J(jacobians[end]);
      J.col(6).setZero();
      for (int i = 0; i < 6; ++i) J.row(i).head<6>() = out[i].v.segment<6>(6 * end);
    }
    return true;
  }

 private:
  template <class T>
  Eigen::Matrix<T, 6, 1> residual(const Eigen::Matrix<T, 3, 1>* t, const Eigen::Quaternion<T>* q) const {
    const Eigen::Matrix<T, 3, 1> ab = q[0].conjugate() * (t[1] - t[0]);
    const Eigen::Matrix<T, 3, 1> u = ab / sqrt(ab.squaredNorm() + T(1e-12));
    const Eigen::Quaternion<T> inverse = q_.conjugate().template cast<T>();
    const Eigen::Quaternion<T> turn = inverse * (q[0].conjugate() * q[1]);
    const T wxyz[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
    Eigen::Matrix<T, 5, 1> e;
    e.template head<2>() = B_.template cast<T>() * (inverse * u);
    ceres::QuaternionToAngleAxis(wxyz, e.data() + 2);
    Eigen::Matrix<T, 6, 1> r;
    r.template head<5>() = W_.template cast<T>() * e;
    r[5] = T(W_(0, 0)) * (T(d_.squaredNorm()) - d_.template cast<T>().dot(u));
    return r;
  }

  Eigen::Matrix<double, 5, 5> W_ = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 2, 3> B_ = Eigen::Matrix<double, 2, 3>::Zero();  // zeros: the rotation alone
  Vector3d d_ = Vector3d::Zero();
  Eigen::Quaterniond q_;
};

PlanarDirection planarDirection(const types::RelPose& T_a_b, const Matrix3d& cov) {
  PlanarDirection r{Eigen::Matrix2d::Zero(), 0, 0, yawOf(T_a_b.T_a_b)};
  r.W(1, 1) = 1 / std::sqrt(cov(2, 2));
  const Eigen::Vector2d d = T_a_b.T_a_b.translation().head<2>();
  if (d.norm() < 1e-6) return r;
  // Motions of the measured pose are given in the frame of b; across the direction they turn it.
  const Eigen::Vector2d u = d.normalized();
  Eigen::Matrix<double, 2, 3> J = Eigen::Matrix<double, 2, 3>::Zero();
  J.block<1, 2>(0, 0) = (Eigen::Rotation2Dd(-r.yaw) * Eigen::Vector2d(-u.y(), u.x())).transpose();
  J(1, 2) = 1;
  if (const auto W = whitening<2>(J * cov * J.transpose())) {
    r.W = *W;
    r.dx = u.x();
    r.dy = u.y();
  }
  return r;
}

}  // namespace

PoseBlock toBlock(const Eigen::Isometry3d& T) {
  PoseBlock block;
  Eigen::Map<Vector3d>{block.data()} = T.translation();
  Eigen::Map<Eigen::Quaterniond>{block.data() + 3} = Eigen::Quaterniond(T.linear()).normalized();
  return block;
}

Eigen::Isometry3d fromBlock(const PoseBlock& block) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Map<const Vector3d>(block.data());
  T.linear() = Eigen::Map<const Eigen::Quaterniond>(block.data() + 3).normalized().toRotationMatrix();
  return T;
}

bool PoseManifold::Plus(const double* x, const double* d, double* out) const {
  const Eigen::Map<const Eigen::Quaterniond> q(x + 3);
  const Eigen::Isometry3d step = expSe3(Eigen::Map<const Vector6d>(d));
  Eigen::Map<Vector3d>{out} = Eigen::Map<const Vector3d>(x) + q * step.translation();
  Eigen::Map<Eigen::Quaterniond>{out + 3} = (q * Eigen::Quaterniond(step.linear())).normalized();
  return true;
}

bool PoseManifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>{jacobian}.setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* out) const {
  const Eigen::Map<const Eigen::Quaterniond> qx(x + 3), qy(y + 3);
  const Vector3d w = rotationVector(qx.conjugate() * qy);
  const Vector3d t = qx.conjugate() * (Eigen::Map<const Vector3d>(y) - Eigen::Map<const Vector3d>(x));
  Eigen::Map<Vector3d>{out} = inverseLeftJacobian(w) * t;
  Eigen::Map<Vector3d>{out + 3} = w;
  return true;
}

bool PoseManifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Matrix67>{jacobian}.setIdentity();
  return true;
}

std::unique_ptr<ceres::CostFunction> planarCost(const types::RelPose& T_a_b) {
  static const std::vector<int> kPlane{0, 1, 5};
  const Matrix3d cov = T_a_b.cov(kPlane, kPlane);
  if (!T_a_b.hasScale)
    return std::make_unique<ceres::AutoDiffCostFunction<PlanarDirection, 3, 3, 3>>(
        new PlanarDirection(planarDirection(T_a_b, cov)));
  const Vector3d t = T_a_b.T_a_b.translation();
  return std::make_unique<PlanarScaled>(*whitening<3>(cov), t.x(), t.y(), yawOf(T_a_b.T_a_b));
}

std::unique_ptr<ceres::CostFunction> spatialCost(const types::RelPose& T_a_b) {
  if (!T_a_b.hasScale) return std::make_unique<SpatialDirection>(T_a_b);
  return std::make_unique<SpatialScaled>(T_a_b);
}

}  // namespace engram::posegraph
