// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/map_builder.h"

#include "engram/pipeline/mapper.h"
#include "engram/pipeline/view_mapper.h"

namespace engram::pipeline {

std::unique_ptr<MapBuilder> makeMapBuilder(const PipelineParams& params, map::TopologicalMap map) {
  if (params.mapping.nodes == "views") return std::make_unique<ViewMapper>(params, std::move(map));
  return std::make_unique<Mapper>(params, std::move(map));
}

}  // namespace engram::pipeline
