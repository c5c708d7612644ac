// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tiny_map.h"

#include "engram/pipeline/pipeline.h"
#include "tiny_drive.h"

namespace engram::testing {

const map::TopologicalMap& firstMap() {
  static const map::TopologicalMap map = [] {
    pipeline::Pipeline mapper(tinyParams());
    for (const auto& frame : firstDrive().frames) mapper.process(frame);
    mapper.finish();
    return std::move(mapper).release();
  }();
  return map;
}

}  // namespace engram::testing
