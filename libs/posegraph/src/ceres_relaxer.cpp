// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "indexed_graph.h"
#include "relaxers.h"
#include "residuals.h"

#include <ceres/ceres.h>

#include <array>
#include <cmath>

namespace engram::posegraph {
namespace {

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

std::unique_ptr<ceres::LossFunction> newKernel(const RelaxerParams& p) {
  if (p.kernel == "huber") return std::make_unique<ceres::HuberLoss>(p.kernel_width);
  if (p.kernel == "cauchy") return std::make_unique<ceres::CauchyLoss>(p.kernel_width);
  if (p.kernel == "dcs") return std::make_unique<DcsLoss>(p.kernel_width);
  return nullptr;
}

/// Whether x, y and yaw can be solved alone because nothing measured leaves the plane or mixes with it: the
/// spatial optimum is then the planar one.
bool liesInAPlane(const Graph& graph) {
  const auto flat = [](const Eigen::Isometry3d& T) {
    return std::abs(T.linear()(2, 2) - 1) < 1e-12 && std::abs(T.translation().z()) < 1e-9;
  };
  for (const auto& [id, T] : graph.poses)
    if (!flat(T)) return false;
  for (const Constraint& c : graph.constraints) {
    if (!c.T_a_b.hasScale || !flat(c.T_a_b.T_a_b)) return false;
    for (const int i : {0, 1, 5})
      for (const int j : {2, 3, 4})
        if (c.T_a_b.cov(i, j) != 0) return false;
  }
  return true;
}

/// Free poses in contiguous memory and the constraints over them.
class Problem {
 public:
  Problem(const Graph& graph, const std::set<PlaceId>& held, const RelaxerParams& params)
      : planar_(params.planar || liesInAPlane(graph)),
        graph_(graph),
        index_(graph),
        fixed_(index_.anchors(held)),
        kernel_(newKernel(params)),
        problem_(options()) {
    for (const auto& [id, T] : graph.poses) {
      if (planar_)
        flat_.push_back({T.translation().x(), T.translation().y(), yawOf(T)});
      else
        full_.push_back(toBlock(T));
    }
    for (std::size_t i = 0; i < index_.size(); ++i) {
      problem_.AddParameterBlock(block(i), planar_ ? 3 : 7, planar_ ? nullptr : &manifold_);
      if (fixed_[i]) problem_.SetParameterBlockConstant(block(i));
    }
    for (std::size_t k = 0; k < graph.constraints.size(); ++k) add(k);
  }

  ceres::Problem& ceres() { return problem_; }

  std::map<PlaceId, Eigen::Isometry3d> poses() const {
    std::map<PlaceId, Eigen::Isometry3d> out = graph_.poses;
    std::size_t i = 0;
    for (auto& [id, T] : out) {
      if (fixed_[i]) {
      } else if (planar_) {
        setPlanar(T, flat_[i][0], flat_[i][1], flat_[i][2]);
      } else {
        T = fromBlock(full_[i]);
      }
      ++i;
    }
    return out;
  }

 private:
  static ceres::Problem::Options options() {
    ceres::Problem::Options o;
    o.manifold_ownership = o.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    o.disable_all_safety_checks = true;  // requireValid() has seen to it
    return o;
  }

  double* block(std::size_t i) { return planar_ ? flat_[i].data() : full_[i].data(); }

  void add(std::size_t k) {
    const Constraint& c = graph_.constraints[k];
    auto cost = planar_ ? planarCost(c.T_a_b) : spatialCost(c.T_a_b);
    problem_.AddResidualBlock(cost.release(), c.robust ? kernel_.get() : nullptr, block(index_.a(k)),
                              block(index_.b(k)));
  }

  bool planar_;
  const Graph& graph_;
  IndexedGraph index_;
  std::vector<char> fixed_;
  std::unique_ptr<ceres::LossFunction> kernel_;
  PoseManifold manifold_;
  std::vector<std::array<double, 3>> flat_;
  std::vector<PoseBlock> full_;
  ceres::Problem problem_;
};

class CeresRelaxer : public Relaxer {
 public:
  explicit CeresRelaxer(const RelaxerParams& params) : params_(params) {}

 private:
  Relaxation run(const Graph& graph, const std::set<PlaceId>& held, bool online) const override {
    Relaxation out;
    out.poses = graph.poses;
    if (graph.constraints.empty()) return out;
    Problem problem(graph, held, params_);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    options.max_num_iterations = online ? params_.window_iterations : params_.max_iterations;
    // Nearly Gauss-Newton: half the iterations of the default 1e4; steps that fail shrink it.
    options.initial_trust_region_radius = 1e8;
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

  RelaxerParams params_;
};

}  // namespace

std::unique_ptr<Relaxer> makeCeresRelaxer(const RelaxerParams& params) {
  return std::make_unique<CeresRelaxer>(params);
}

}  // namespace engram::posegraph
