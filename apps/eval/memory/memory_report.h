// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "memory/lab_figures.h"
#include "memory/static_place.h"

#include <string>
#include <vector>

namespace engram::apps {

/// Everything on the page of engram-eval memory.
struct MemoryReport {
  std::vector<LabFigure> figures;
  std::vector<MethodRun> runs;
  std::vector<LabFigure> swept;  ///< empty when no sweep was run
  std::vector<Advantage> advantages;
  std::vector<StaticPlaceResult> staticPlaces;  ///< empty when it was not run
  LabDrives drives;
  MemoryLabParams lab;
  std::string settings;  ///< the configuration in force
  std::uint64_t seed = 1;
};

/// The page: the figures 6 and 9 to 17 of Bacca, Salvi & Cufi 2011 from our data, tables with intervals, and
/// what made them.
std::string toHtml(const MemoryReport& report);

}  // namespace engram::apps
