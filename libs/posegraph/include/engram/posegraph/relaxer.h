// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/posegraph/graph.h"

#include <map>
#include <memory>
#include <string>

namespace engram::posegraph {

/// Section [posegraph].
struct RelaxerParams {
  std::string relaxer = "ceres";
  bool planar = true;  ///< only x, y and yaw are free
  std::string kernel = "cauchy";
  double kernel_width = 2.0;  ///< [standard deviations]
  int max_iterations = 50;
  double max_seconds = 0.0;  ///< [s]
  void describe(base::Params& p);
};

/// How a relaxation ended.
enum class Ending {
  kNothingToDo,  ///< fewer than two places, or no constraint
  kConverged,
  kIterationLimit,  ///< or time limit; the poses are better than before
  kFailed,          ///< the solver gave up: the poses are as before
};

const char* toString(Ending ending);

struct Relaxation {
  Ending ending = Ending::kNothingToDo;
  std::map<PlaceId, Eigen::Isometry3d> poses;  ///< T_map_place of every place of the graph
  double chi2Before = 0, chi2After = 0;        ///< sum of weighted squared residuals, kernels applied
  int iterations = 0;
};

/// Moves the places so that the constraints fit best. The first place of every connected part stays where it
/// is. The same graph gives the same poses. Throws base::Error when requireValid() does.
class Relaxer {
 public:
  virtual ~Relaxer() = default;
  virtual Relaxation relax(const Graph& graph) const = 0;
};

/// Throws base::ConfigError for an unknown name or a value out of range.
std::unique_ptr<Relaxer> makeRelaxer(const RelaxerParams& params);

}  // namespace engram::posegraph
