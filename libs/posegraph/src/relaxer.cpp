// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/relaxer.h"

#include "engram/base/error.h"
#include "relaxers.h"

#include <Eigen/Cholesky>

#include <cmath>

namespace engram::posegraph {

void RelaxerParams::describe(base::Params& p) {
  p.addChoice(
      "relaxer", relaxer,
      "Solver: ceres; duckett (Angeli et al.; x, y and yaw, no kernel, slow in large loops); MRPT's "
      "levmarq (right only with equal weights; knows no kernel); or, for maps of scans alone, ekf_scans "
      "(Bertolli et al.; a Kalman filter over all poses, slow in large maps)",
      {"ceres", "duckett", "mrpt_levmarq", "ekf_scans"});
  p.add("planar", planar, "The robot moves on a plane: only x, y and yaw of the places are free");
  p.addChoice("kernel", kernel, "Robust kernel on closures: bounds the pull of a false one",
              {"none", "huber", "cauchy", "dcs"});
  p.add("kernel_width", kernel_width, "Residual from which the kernel bends [standard deviations]",
        {1e-3, 1e6});
  p.add("max_iterations", max_iterations, "Iterations of one relaxation", {1, 10000});
  p.add("max_seconds", max_seconds,
        "Time for one relaxation, 0 for no limit [s]; with a limit, equal runs may give maps that differ",
        base::atLeast(0));
  p.add("window_hops", window_hops, "Reach of the relaxation after one image [edges]", {1, 1000});
  p.add("window_places", window_places, "Places that it moves at most", {1, 100000});
  p.add("window_iterations", window_iterations, "Iterations of the relaxation after one image", {1, 10000});
  p.add("duckett_max_sweeps", duckett_max_sweeps, "Iterations of duckett over the whole map", {1, 10000000});
  p.add("duckett_tolerance", duckett_tolerance,
        "Mean change of a place below which duckett ends; 1 rad counts as 1 m [m]", {0, 1});
  gate.describe(p);
}

const char* toString(Ending ending) {
  switch (ending) {
    case Ending::kNothingToDo:
      return "nothing to do";
    case Ending::kConverged:
      return "converged";
    case Ending::kIterationLimit:
      return "iteration limit";
    case Ending::kFailed:
      return "failed";
  }
  return "?";
}

double yawOf(const Eigen::Isometry3d& T) { return std::atan2(T(1, 0), T(0, 0)); }

void setPlanar(Eigen::Isometry3d& T, double x, double y, double yaw) {
  T.linear() = Eigen::AngleAxisd(yaw - yawOf(T), Eigen::Vector3d::UnitZ()).toRotationMatrix() * T.linear();
  T.translation().head<2>() << x, y;
}

double chi2(const Graph& graph, const std::map<PlaceId, Eigen::Isometry3d>& poses, bool planar) {
  static const std::vector<int> kPlane{0, 1, 5};
  double sum = 0;
  for (const Constraint& c : graph.constraints) {
    if (!c.T_a_b.hasScale) continue;
    const Eigen::Matrix<double, 6, 1> e = residual(c.T_a_b, poses.at(c.a), poses.at(c.b));
    if (planar) {
      const Eigen::Vector3d flat = e(kPlane);
      const Eigen::Matrix3d cov = c.T_a_b.cov(kPlane, kPlane);
      sum += flat.dot(cov.ldlt().solve(flat));
    } else {
      sum += e.dot(c.T_a_b.cov.ldlt().solve(e));
    }
  }
  return sum;
}

namespace {

double misfit(const Graph& graph, const std::map<PlaceId, Eigen::Isometry3d>& poses) {
  double sum = 0;
  std::size_t n = 0;
  for (const Constraint& c : graph.constraints) {
    if (!c.T_a_b.hasScale) continue;
    sum += residual(c.T_a_b, poses.at(c.a), poses.at(c.b)).head<3>().squaredNorm();
    ++n;
  }
  return n == 0 ? 0 : std::sqrt(sum / static_cast<double>(n));
}

}  // namespace

Relaxation Relaxer::relax(const Graph& graph) const {
  requireValid(graph);
  Relaxation out = run(graph, {}, false);
  out.misfit = misfit(graph, out.poses);
  return out;
}

Relaxation Relaxer::relax(const Window& window) const {
  requireValid(window.graph);
  Relaxation out = run(window.graph, window.held, true);
  out.misfit = misfit(window.graph, out.poses);
  return out;
}

Relaxation relaxAround(const Relaxer& relaxer, const RelaxerParams& params, Graph& graph,
                       const Adjacency& adjacency, PlaceId centre) {
  Relaxation out =
      relaxer.relax(windowAround(graph, adjacency, centre, params.window_hops, params.window_places));
  for (const auto& [id, T] : out.poses) graph.poses[id] = T;
  return out;
}

std::unique_ptr<Relaxer> makeRelaxer(const RelaxerParams& params) {
  base::validate(params);
  if (params.relaxer == "ceres") return makeCeresRelaxer(params);
  if (params.relaxer == "duckett") return makeDuckettRelaxer(params);
  if (params.relaxer == "mrpt_levmarq") return makeMrptRelaxer(params);
  throw base::ConfigError("relaxer = " + params.relaxer +
                          ": relaxes no graph; use ceres, duckett or mrpt_levmarq");
}

}  // namespace engram::posegraph
