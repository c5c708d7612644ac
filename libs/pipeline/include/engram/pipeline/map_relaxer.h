// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"
#include "engram/posegraph/relaxer.h"

#include <memory>

namespace engram::pipeline {

/// Relax: the places of a map follow what its edges say. A relaxation that fails leaves them.
class MapRelaxer {
 public:
  explicit MapRelaxer(const posegraph::RelaxerParams& params)
      : params_(params), relaxer_(posegraph::makeRelaxer(params)) {}

  /// The surroundings of a place: what one image costs, however large the map.
  void around(map::TopologicalMap& map, base::PlaceId centre) const;
  /// The whole map, to the end.
  void all(map::TopologicalMap& map) const;

 private:
  posegraph::RelaxerParams params_;
  std::unique_ptr<posegraph::Relaxer> relaxer_;
};

}  // namespace engram::pipeline
