// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "relaxers.h"

#include <Eigen/Cholesky>
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <array>
#include <cmath>
#include <optional>

namespace engram::posegraph {
namespace {

template <class T, int n>
using Vector = Eigen::Matrix<T, n, 1>;

/// W with W^T W = cov^-1; none when cov is not positive definite.
std::optional<Eigen::MatrixXd> whitening(const Eigen::MatrixXd& cov) {
  const Eigen::LLT<Eigen::MatrixXd> llt(cov);
  if (llt.info() != Eigen::Success) return std::nullopt;
  return llt.matrixL().solve(Eigen::MatrixXd::Identity(cov.rows(), cov.cols()));
}

/// Two unit vectors perpendicular to the unit vector d, as rows.
Eigen::Matrix<double, 2, 3> tangentBasis(const Eigen::Vector3d& d) {
  const Eigen::Vector3d u = d.unitOrthogonal();
  Eigen::Matrix<double, 2, 3> B;
  B.row(0) = u;
  B.row(1) = d.cross(u);
  return B;
}

/// SE(3) logarithm for Jets, see logSe3().
template <class T>
Vector<T, 6> logarithm(const Vector<T, 3>& t, const Eigen::Quaternion<T>& q) {
  const T wxyz[4] = {q.w(), q.x(), q.y(), q.z()};
  Vector<T, 3> w;
  ceres::QuaternionToAngleAxis(wxyz, w.data());
  const T square = w.squaredNorm();
  T k = T(1.0 / 12);
  if (square > T(1e-8)) {
    const T angle = sqrt(square);
    k = T(1) / square - (T(1) + cos(angle)) / (T(2) * angle * sin(angle));
  }
  const Vector<T, 3> wt = w.cross(t);
  Vector<T, 6> v;
  v << t - T(0.5) * wt + k * w.cross(wt), w;
  return v;
}

/// A free pose: translation and quaternion (x, y, z, w).
struct FullPose {
  double t[3];
  double q[4];
};

/// T_a^-1 T_b as translation and rotation.
template <class T>
std::pair<Vector<T, 3>, Eigen::Quaternion<T>> between(const T* ta, const T* qa, const T* tb, const T* qb) {
  const Eigen::Quaternion<T> a = Eigen::Map<const Eigen::Quaternion<T>>(qa).conjugate();
  const Vector<T, 3> d = Eigen::Map<const Vector<T, 3>>(tb) - Eigen::Map<const Vector<T, 3>>(ta);
  return {a * d, a * Eigen::Map<const Eigen::Quaternion<T>>(qb)};
}

/// K-E2 with scale: Log(T_measured^-1 T_a^-1 T_b), whitened.
struct ScaledResidual {
  Eigen::Matrix<double, 6, 6> W;
  Eigen::Vector3d t;
  Eigen::Quaterniond q;

  template <class T>
  bool operator()(const T* ta, const T* qa, const T* tb, const T* qb, T* out) const {
    const auto [tab, qab] = between(ta, qa, tb, qb);
    const Eigen::Quaternion<T> inverse = q.conjugate().template cast<T>();
    const Vector<T, 3> gap = tab - t.template cast<T>();
    Eigen::Map<Vector<T, 6>> r(out);
    r = W.template cast<T>() * logarithm<T>(inverse * gap, inverse * qab);
    return true;
  }
};

/// Without scale: the direction of the translation on its tangent plane, and the rotation. The sixth residual
/// keeps the direction from settling on its opposite, where the tangent part is zero too. B of zeros: the
/// rotation alone.
struct DirectionResidual {
  Eigen::Matrix<double, 5, 5> W;
  Eigen::Matrix<double, 2, 3> B;
  Eigen::Vector3d d;
  Eigen::Quaterniond q;

  template <class T>
  bool operator()(const T* ta, const T* qa, const T* tb, const T* qb, T* out) const {
    const auto [tab, qab] = between(ta, qa, tb, qb);
    const Vector<T, 3> u = tab / sqrt(tab.squaredNorm() + T(1e-12));
    Vector<T, 5> e;
    e.template head<2>() = B.template cast<T>() * (q.conjugate().template cast<T>() * u);
    e.template tail<3>() =
        logarithm<T>(Vector<T, 3>::Zero(), q.conjugate().template cast<T>() * qab).template tail<3>();
    Eigen::Map<Vector<T, 6>> r(out);
    r.template head<5>() = W.template cast<T>() * e;
    r[5] = T(W(0, 0)) * (T(d.squaredNorm()) - d.template cast<T>().dot(u));
    return true;
  }
};

/// SE(2) with scale: Log(T_measured^-1 T_a^-1 T_b) in x, y, yaw, whitened.
struct PlanarResidual {
  Eigen::Matrix3d W;
  double x, y, yaw;

  template <class T>
  bool operator()(const T* a, const T* b, T* out) const {
    const T turn = a[2] + T(yaw);
    const T dx = b[0] - a[0] - (cos(a[2]) * x - sin(a[2]) * y),
            dy = b[1] - a[1] - (sin(a[2]) * x + cos(a[2]) * y);
    T w = b[2] - turn;
    w = atan2(sin(w), cos(w));
    // Inverse of the left Jacobian of SE(2): (w / 2) cot(w / 2) and w / 2.
    const T half = w * T(0.5);
    const T k = half * half < T(1e-8) ? T(1) - half * half / T(3) : half * cos(half) / sin(half);
    const T ex = cos(turn) * dx + sin(turn) * dy, ey = -sin(turn) * dx + cos(turn) * dy;
    Eigen::Map<Vector<T, 3>> r(out);
    r = W.template cast<T>() * Vector<T, 3>(k * ex + half * ey, k * ey - half * ex, w);
    return true;
  }
};

/// SE(2) without scale: direction and yaw; see DirectionResidual.
struct PlanarDirectionResidual {
  Eigen::Matrix2d W;
  double dx, dy, yaw;  // d = 0 for a pure rotation: yaw alone

  template <class T>
  bool operator()(const T* a, const T* b, T* out) const {
    const T gx = b[0] - a[0], gy = b[1] - a[1];
    const T n = sqrt(gx * gx + gy * gy + T(1e-12));
    const T ux = (cos(a[2]) * gx + sin(a[2]) * gy) / n, uy = (-sin(a[2]) * gx + cos(a[2]) * gy) / n;
    const T w = b[2] - a[2] - T(yaw);
    Eigen::Map<Vector<T, 3>> r(out);
    r.template head<2>() = W.template cast<T>() * Vector<T, 2>(dx * uy - dy * ux, atan2(sin(w), cos(w)));
    r[2] = T(W(0, 0)) * (T(dx * dx + dy * dy) - dx * ux - dy * uy);
    return true;
  }
};

/// Dynamic covariance scaling (Agarwal et al. 2013) as a kernel: slope min(1, 2w / (w + s))^2 for s = squared
/// residual.
class DcsLoss : public ceres::LossFunction {
 public:
  explicit DcsLoss(double width) : w_(width * width) {}
  void Evaluate(double s, double rho[3]) const override {
    if (s <= w_) {
      rho[0] = s;
      rho[1] = 1;
      rho[2] = 0;
      return;
    }
    const double f = 2 * w_ / (w_ + s);
    rho[0] = 3 * w_ - 2 * w_ * f;
    rho[1] = f * f;
    rho[2] = -2 * f * f / (w_ + s);
  }

 private:
  double w_;
};

ceres::LossFunction* newKernel(const RelaxerParams& p) {
  if (p.kernel == "huber") return new ceres::HuberLoss(p.kernel_width);
  if (p.kernel == "cauchy") return new ceres::CauchyLoss(p.kernel_width);
  if (p.kernel == "dcs") return new DcsLoss(p.kernel_width);
  return nullptr;
}

double yawOf(const Eigen::Isometry3d& T) { return std::atan2(T(1, 0), T(0, 0)); }

/// Free poses in contiguous memory and the constraints over them.
class Problem {
 public:
  Problem(const Graph& graph, const RelaxerParams& params) : params_(params), graph_(graph) {
    for (const auto& [id, T] : graph.poses) {
      index_[id] = planar_.size();
      planar_.push_back({T.translation().x(), T.translation().y(), yawOf(T)});
      FullPose& full = full_.emplace_back();
      Eigen::Map<Eigen::Vector3d>(full.t) = T.translation();
      Eigen::Map<Eigen::Quaterniond>(full.q) = Eigen::Quaterniond(T.linear()).normalized();
    }
    for (const Constraint& c : graph.constraints) params.planar ? addPlanar(c) : addFull(c);
    fixAnchors();
  }

  ceres::Problem& ceres() { return problem_; }

  std::map<PlaceId, Eigen::Isometry3d> poses() const {
    std::map<PlaceId, Eigen::Isometry3d> out = graph_.poses;
    for (auto& [id, T] : out) {
      const std::size_t i = index_.at(id);
      if (params_.planar) {
        const auto& p = planar_[i];
        // Height, roll and pitch stay.
        T.linear() =
            Eigen::AngleAxisd(p[2] - yawOf(T), Eigen::Vector3d::UnitZ()).toRotationMatrix() * T.linear();
        T.translation().head<2>() << p[0], p[1];
      } else {
        T.translation() = Eigen::Map<const Eigen::Vector3d>(full_[i].t);
        T.linear() = Eigen::Map<const Eigen::Quaterniond>(full_[i].q).normalized().toRotationMatrix();
      }
    }
    return out;
  }

 private:
  ceres::LossFunction* kernel(const Constraint& c) const { return c.robust ? newKernel(params_) : nullptr; }

  void addPlanar(const Constraint& c) {
    double* a = planar_[index_.at(c.a)].data();
    double* b = planar_[index_.at(c.b)].data();
    const auto& T = c.T_a_b.T_a_b;
    const std::vector<int> kept{0, 1, 5};
    if (c.T_a_b.hasScale) {
      const Eigen::Matrix3d W = *whitening(c.T_a_b.cov(kept, kept));
      auto* r = new PlanarResidual{W, T.translation().x(), T.translation().y(), yawOf(T)};
      problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<PlanarResidual, 3, 3, 3>(r), kernel(c), a, b);
      return;
    }
    const Eigen::Vector2d d = T.translation().head<2>();
    const double length = d.norm();
    PlanarDirectionResidual r{Eigen::Matrix2d::Zero(), 0, 0, yawOf(T)};
    r.W(1, 1) = 1 / std::sqrt(c.T_a_b.cov(5, 5));
    if (length > 1e-6) {
      // Motions of the measured pose are given in the frame of b; across the direction they turn it.
      const Eigen::Vector2d u = d / length;
      const Eigen::Vector2d inB = Eigen::Rotation2Dd(-r.yaw) * Eigen::Vector2d(-u.y(), u.x());
      Eigen::Matrix<double, 2, 3> J = Eigen::Matrix<double, 2, 3>::Zero();
      J.block<1, 2>(0, 0) = inB.transpose();
      J(1, 2) = 1;
      if (const auto W = whitening(J * c.T_a_b.cov(kept, kept) * J.transpose())) {
        r.W = *W;
        r.dx = u.x();
        r.dy = u.y();
      }
    }
    problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<PlanarDirectionResidual, 3, 3, 3>(new PlanarDirectionResidual(r)),
        kernel(c), a, b);
  }

  void addFull(const Constraint& c) {
    FullPose& a = full_[index_.at(c.a)];
    FullPose& b = full_[index_.at(c.b)];
    const Eigen::Quaterniond q(c.T_a_b.T_a_b.linear());
    const Eigen::Vector3d t = c.T_a_b.T_a_b.translation();
    ceres::CostFunction* cost = nullptr;
    if (c.T_a_b.hasScale) {
      cost = new ceres::AutoDiffCostFunction<ScaledResidual, 6, 3, 4, 3, 4>(
          new ScaledResidual{*whitening(c.T_a_b.cov), t, q.normalized()});
    } else {
      cost = new ceres::AutoDiffCostFunction<DirectionResidual, 6, 3, 4, 3, 4>(
          new DirectionResidual(directionResidual(c.T_a_b.cov, t, q.normalized())));
    }
    problem_.AddResidualBlock(cost, kernel(c), a.t, a.q, b.t, b.q);
  }

  static DirectionResidual directionResidual(const types::Matrix6d& cov, const Eigen::Vector3d& t,
                                             const Eigen::Quaterniond& q) {
    DirectionResidual r{Eigen::Matrix<double, 5, 5>::Zero(), Eigen::Matrix<double, 2, 3>::Zero(),
                        Eigen::Vector3d::Zero(), q};
    r.W.bottomRightCorner<3, 3>() = *whitening(cov.bottomRightCorner<3, 3>());
    if (t.norm() < 1e-6) return r;
    const Eigen::Matrix<double, 2, 3> B = tangentBasis(q.conjugate() * t.normalized());
    Eigen::Matrix<double, 5, 6> J = Eigen::Matrix<double, 5, 6>::Zero();
    J.topLeftCorner<2, 3>() = B;
    J.bottomRightCorner<3, 3>().setIdentity();
    if (const auto W = whitening(J * cov * J.transpose())) {
      r.W = *W;
      r.B = B;
      r.d = t.normalized();
    }
    return r;
  }

  void fixAnchors() {
    const auto fixed = anchors(graph_);
    for (const auto& [id, i] : index_) {
      const bool fix = fixed.contains(id);
      if (params_.planar) {
        if (fix && problem_.HasParameterBlock(planar_[i].data()))
          problem_.SetParameterBlockConstant(planar_[i].data());
        continue;
      }
      FullPose& p = full_[i];
      if (!problem_.HasParameterBlock(p.q)) continue;
      problem_.SetManifold(p.q, new ceres::EigenQuaternionManifold);
      if (!fix) continue;
      problem_.SetParameterBlockConstant(p.t);
      problem_.SetParameterBlockConstant(p.q);
    }
  }

  const RelaxerParams& params_;
  const Graph& graph_;
  std::map<PlaceId, std::size_t> index_;
  std::vector<std::array<double, 3>> planar_;
  std::vector<FullPose> full_;
  ceres::Problem problem_;
};

class CeresRelaxer : public Relaxer {
 public:
  explicit CeresRelaxer(const RelaxerParams& params) : params_(params) {}

  Relaxation relax(const Graph& graph) const override {
    requireValid(graph);
    Relaxation out;
    out.poses = graph.poses;
    if (graph.constraints.empty()) return out;
    Problem problem(graph, params_);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    options.max_num_iterations = params_.max_iterations;
    options.function_tolerance = 1e-9;
    options.parameter_tolerance = 1e-10;
    if (params_.max_seconds > 0) options.max_solver_time_in_seconds = params_.max_seconds;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem.ceres(), &summary);
    out.chi2Before = 2 * summary.initial_cost;
    out.chi2After = 2 * summary.final_cost;
    out.iterations = static_cast<int>(summary.iterations.size());
    out.ending = Ending::kFailed;
    if (!summary.IsSolutionUsable()) return out;
    out.ending =
        summary.termination_type == ceres::CONVERGENCE ? Ending::kConverged : Ending::kIterationLimit;
    out.poses = problem.poses();
    return out;
  }

 private:
  RelaxerParams params_;
};

}  // namespace

std::unique_ptr<Relaxer> makeCeresRelaxer(const RelaxerParams& params) {
  return std::make_unique<CeresRelaxer>(params);
}

}  // namespace engram::posegraph
