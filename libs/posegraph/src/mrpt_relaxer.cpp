// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "indexed_graph.h"
#include "relaxers.h"

#include <Eigen/LU>
#include <mrpt/containers/yaml.h>
#include <mrpt/graphs/CNetworkOfPoses.h>
#include <mrpt/graphslam/levmarq.h>

namespace engram::posegraph {
namespace {

mrpt::poses::CPose3D toPose(const Eigen::Isometry3d& T, const mrpt::poses::CPose3D*) {
  return mrpt::poses::CPose3D(mrpt::math::CMatrixDouble44(T.matrix()));
}

mrpt::poses::CPose2D toPose(const Eigen::Isometry3d& T, const mrpt::poses::CPose2D*) {
  return {T.translation().x(), T.translation().y(), yawOf(T)};
}

/// levmarq weighs the logarithm of the gap, so it must be given information about motions, not about MRPT's
/// angles.
mrpt::poses::CPose3DPDFGaussianInf toEdge(const types::RelPose& z, const mrpt::poses::CPose3D* as) {
  const types::Matrix6d information = z.cov.inverse();
  mrpt::poses::CPose3DPDFGaussianInf edge(toPose(z.T_a_b, as));
  edge.cov_inv = mrpt::math::CMatrixDouble66(((information + information.transpose()) / 2).eval());
  return edge;
}

mrpt::poses::CPosePDFGaussianInf toEdge(const types::RelPose& z, const mrpt::poses::CPose2D* as) {
  static const std::vector<int> kPlane{0, 1, 5};
  const Eigen::Matrix3d cov = z.cov(kPlane, kPlane), information = cov.inverse();
  mrpt::poses::CPosePDFGaussianInf edge(toPose(z.T_a_b, as));
  edge.cov_inv = mrpt::math::CMatrixDouble33(((information + information.transpose()) / 2).eval());
  return edge;
}

template <class Network>
Network toNetwork(const Graph& graph) {
  using Pose = typename Network::constraint_no_pdf_t;
  const Pose* const as = nullptr;
  Network network;
  for (const auto& [id, T] : graph.poses) network.nodes[id.value] = toPose(T, as);
  if (!graph.poses.empty()) network.root = graph.poses.begin()->first.value;
  for (const Constraint& c : graph.constraints)
    if (c.T_a_b.hasScale) network.insertEdge(c.a.value, c.b.value, toEdge(c.T_a_b, as));
  return network;
}

void take(Eigen::Isometry3d& T, const mrpt::poses::CPose3D& pose) {
  T.matrix() = pose.getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>().asEigen();
}

void take(Eigen::Isometry3d& T, const mrpt::poses::CPose2D& pose) {
  setPlanar(T, pose.x(), pose.y(), pose.phi());
}

/// MRPT's levmarq, for comparison. It judges its steps without the information matrix, so with unequal
/// weights it ends away from the optimum, and it starts from `graph.poses`.
class MrptRelaxer : public Relaxer {
 public:
  explicit MrptRelaxer(const RelaxerParams& params) : params_(params) {}

 private:
  Relaxation run(const Graph& graph, const std::set<PlaceId>& held, bool online) const override {
    const int limit = online ? params_.window_iterations : params_.max_iterations;
    if (params_.planar) return solve<mrpt::graphs::CNetworkOfPoses2DInf>(graph, held, limit);
    return solve<mrpt::graphs::CNetworkOfPoses3DInf>(graph, held, limit);
  }

  template <class Network>
  Relaxation solve(const Graph& graph, const std::set<PlaceId>& held, int limit) const {
    Relaxation out;
    out.poses = graph.poses;
    auto network = toNetwork<Network>(graph);
    if (network.edges.empty()) return out;
    const IndexedGraph index(graph);
    const std::vector<char> fixed = index.anchors(held);
    std::set<mrpt::graphs::TNodeID> free;
    for (std::size_t i = 0; i < fixed.size(); ++i)
      if (!fixed[i]) free.insert(index.id(i).value);
    out.chi2Before = chi2(graph, out.poses, params_.planar);
    mrpt::containers::yaml options = mrpt::containers::yaml::Map();
    options["max_iterations"] = limit;
    mrpt::graphslam::TResultInfoSpaLevMarq info;
    mrpt::graphslam::optimize_graph_spa_levmarq(network, info, &free, options);
    out.iterations = static_cast<int>(info.num_iters);
    auto moved = graph.poses;
    for (auto& [id, T] : moved)
      if (free.contains(id.value)) take(T, network.nodes.at(id.value));
    out.chi2After = chi2(graph, moved, params_.planar);
    out.ending = Ending::kFailed;
    // It reports neither failure nor divergence, so both are looked for here.
    if (!(out.chi2After <= out.chi2Before)) {
      out.chi2After = out.chi2Before;
      return out;
    }
    out.poses = std::move(moved);
    out.ending = out.iterations < limit ? Ending::kConverged : Ending::kIterationLimit;
    return out;
  }

  RelaxerParams params_;
};

}  // namespace

std::unique_ptr<Relaxer> makeMrptRelaxer(const RelaxerParams& params) {
  return std::make_unique<MrptRelaxer>(params);
}

}  // namespace engram::posegraph
