// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/relaxer.h"

#include "engram/base/error.h"
#include "relaxers.h"

namespace engram::posegraph {

void RelaxerParams::describe(base::Params& p) {
  p.addChoice("relaxer", relaxer,
              "Solver: ceres, or MRPT's levmarq (right only with equal weights; knows no kernel and no "
              "planar motion)",
              {"ceres", "mrpt_levmarq"});
  p.add("planar", planar, "The robot moves on a plane: only x, y and yaw of the places are free");
  p.addChoice("kernel", kernel, "Robust kernel on closures: bounds the pull of a false one",
              {"none", "huber", "cauchy", "dcs"});
  p.add("kernel_width", kernel_width, "Residual from which the kernel bends [standard deviations]",
        {1e-3, 1e6});
  p.add("max_iterations", max_iterations, "Iterations of one relaxation", {1, 10000});
  p.add("max_seconds", max_seconds,
        "Time for one relaxation, 0 for no limit [s]; with a limit, equal runs may give maps that differ",
        base::atLeast(0));
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

std::set<PlaceId> anchors(const Graph& graph) {
  std::map<PlaceId, std::vector<PlaceId>> neighbours;
  for (const Constraint& c : graph.constraints) {
    neighbours[c.a].push_back(c.b);
    neighbours[c.b].push_back(c.a);
  }
  std::set<PlaceId> first, seen;
  for (const auto& [id, T] : graph.poses) {
    if (!seen.insert(id).second) continue;
    first.insert(id);
    for (std::vector<PlaceId> stack{id}; !stack.empty();) {
      const PlaceId at = stack.back();
      stack.pop_back();
      for (const PlaceId next : neighbours[at])
        if (seen.insert(next).second) stack.push_back(next);
    }
  }
  return first;
}

std::unique_ptr<Relaxer> makeRelaxer(const RelaxerParams& params) {
  base::validate(params);
  if (params.relaxer == "ceres") return makeCeresRelaxer(params);
  if (params.relaxer == "mrpt_levmarq") return makeMrptRelaxer(params);
  throw base::ConfigError("relaxer = " + params.relaxer + ": unknown; use ceres or mrpt_levmarq");
}

}  // namespace engram::posegraph
