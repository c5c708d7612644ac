// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/posegraph/gating.h"
#include "engram/posegraph/graph.h"
#include "engram/posegraph/window.h"

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
  int window_hops = 15;
  int window_places = 150;
  int window_iterations = 20;       ///< A-12: of one image
  int duckett_max_sweeps = 20000;   ///< A-E6: at save and at closures
  double duckett_tolerance = 1e-7;  ///< [m] a place and sweep
  GateParams gate;
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
  double misfit = 0;  ///< root mean square gap that the constraints with scale keep [m]
  int iterations = 0;
  std::map<PlaceId, double> variances;  ///< duckett: its weights (A-E5); no uncertainty
};

/// Moves the places so that the constraints fit best. The same graph gives the same poses. Throws base::Error
/// when requireValid() does.
class Relaxer {
 public:
  virtual ~Relaxer() = default;

  /// The whole graph, to the end. The first place of every connected part stays where it is.
  Relaxation relax(const Graph& graph) const;
  /// A window after an image: at most window_iterations, and the rim stays.
  Relaxation relax(const Window& window) const;

 private:
  virtual Relaxation run(const Graph& graph, const std::set<PlaceId>& held, bool online) const = 0;
};

/// Relaxes the neighbourhood of `centre` and writes its poses back: what one image costs, whatever the size
/// of the map.
Relaxation relaxAround(const Relaxer& relaxer, const RelaxerParams& params, Graph& graph,
                       const Adjacency& adjacency, PlaceId centre);

/// Throws base::ConfigError for an unknown name or a value out of range.
std::unique_ptr<Relaxer> makeRelaxer(const RelaxerParams& params);

}  // namespace engram::posegraph
