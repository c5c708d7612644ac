// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace engram::apps {

/// What one figure of the benchmark has become, from pairs: the same images were shown in both runs.
struct SpeedChange {
  std::string places;  ///< of the map
  std::string what;    ///< `localise`, `map`, or a step of localising
  double before = 0;   ///< [ms] median of the images
  double after = 0;    ///< [ms] the same, as a machine of the speed of then would take
  double ratio = 1;    ///< median over the images of after by before
  double noise = 0;    ///< [log] half of the 99 % interval of `ratio`
  bool slower() const;
  bool faster() const;
};

/// Compares what both runs have measured. How fast the machine was in each is taken out by the fixed work
/// that was measured between the images.
/// @param before, after what `engram-eval bench --json` wrote
/// Throws base::Error when they are of other images, or of an Engram that kept no pairs.
std::vector<SpeedChange> compareSpeed(const nlohmann::json& before, const nlohmann::json& after);

/// One line for each that changed beyond noise, or that none did.
std::string describe(const std::vector<SpeedChange>& changes);

}  // namespace engram::apps
