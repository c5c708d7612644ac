// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/mrpt_graph.h"
#include "indexed_graph.h"
#include "relaxers.h"

#include <Eigen/LU>
#include <mrpt/containers/yaml.h>
#include <mrpt/graphslam/levmarq.h>

namespace engram::posegraph {
namespace {

/// MRPT's levmarq, for comparison. It judges its steps without the information matrix, so with unequal
/// weights it ends away from the optimum; it starts from `graph.poses` and fixes one node only.
class MrptRelaxer : public Relaxer {
 public:
  explicit MrptRelaxer(const RelaxerParams& params) : params_(params) {}

 private:
  Relaxation run(const Graph& graph, const std::set<PlaceId>& held, bool online) const override {
    Relaxation out;
    out.poses = graph.poses;
    auto network = withMotionWeights(graph);
    if (network.edges.empty()) return out;
    const IndexedGraph index(graph);
    const std::vector<char> fixed = index.anchors(held);
    std::set<mrpt::graphs::TNodeID> free;
    for (std::size_t i = 0; i < fixed.size(); ++i)
      if (!fixed[i]) free.insert(index.id(i).value);
    out.chi2Before = chi2(graph, out.poses, false);
    mrpt::containers::yaml options = mrpt::containers::yaml::Map();
    const int limit = online ? params_.window_iterations : params_.max_iterations;
    options["max_iterations"] = limit;
    mrpt::graphslam::TResultInfoSpaLevMarq info;
    mrpt::graphslam::optimize_graph_spa_levmarq(network, info, &free, options);
    out.iterations = static_cast<int>(info.num_iters);
    std::map<PlaceId, Eigen::Isometry3d> moved = fromMrpt(network).poses;
    out.chi2After = chi2(graph, moved, false);
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

  /// levmarq weighs the logarithm of the gap, so it must be given information about motions, not about MRPT's
  /// angles.
  static mrpt::graphs::CNetworkOfPoses3DInf withMotionWeights(const Graph& graph) {
    auto network = toMrpt({graph.poses, {}});
    for (const Constraint& c : graph.constraints) {
      if (!c.T_a_b.hasScale) continue;
      const types::Matrix6d information = c.T_a_b.cov.inverse();
      mrpt::poses::CPose3DPDFGaussianInf edge(
          mrpt::poses::CPose3D(mrpt::math::CMatrixDouble44(c.T_a_b.T_a_b.matrix())));
      edge.cov_inv = mrpt::math::CMatrixDouble66(((information + information.transpose()) / 2).eval());
      network.insertEdge(c.a.value, c.b.value, edge);
    }
    return network;
  }

  RelaxerParams params_;
};

}  // namespace

std::unique_ptr<Relaxer> makeMrptRelaxer(const RelaxerParams& params) {
  return std::make_unique<MrptRelaxer>(params);
}

}  // namespace engram::posegraph
