// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/config.h"
#include "engram/pipeline/params.h"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace engram::pipeline {

/// What a run does with its map.
enum class Use {
  kBuild,     ///< makes or extends it
  kFrozen,    ///< says where the robot is in it; nothing changes
  kAdapting,  ///< that, and its places learn what they are verified to look like
};

enum class Perceive { kFeatures, kPair, kScan };
enum class Move { kWheels, kEyes };
enum class Select { kMotion, kKeyframe, kEvery };
enum class Recognise { kBelief, kIndex, kNear };
enum class Verify { kOneOnTerrain, kOneOnWay, kAllViews, kScans };
enum class Decide { kPlace, kView, kScan, kKnown };
enum class Remember { kPlace, kView, kScan, kLater, kUngated, kNothing };
enum class Relate { kPlace, kView, kScan, kFollow };
enum class Forget { kNothing, kLruViews };
enum class Relax { kPlace, kView, kScan, kNothing };

/// Which strategy does each step of the pipeline.
struct Recipe {
  Perceive perceive;
  Move move;
  Select select;
  Recognise recognise;
  Verify verify;
  Decide decide;
  Remember remember;
  Relate relate;
  Forget forget;
  Relax relax;
};

/// A row for each published system: what it does when it builds a map. All localise in one way, that of F-20
/// and A-14, frozen or adapting.
struct NamedRecipe {
  const char* name;
  const char* paper;
  Recipe build;
};
std::span<const NamedRecipe> recipes();

/// The row that a configuration asks for. Throws base::ConfigError, naming keys, for a combination that no
/// system has.
const NamedRecipe& recipeOf(const PipelineParams& params);

/// The strategies of a run by that configuration.
Recipe recipeFor(const PipelineParams& params, Use use);

/// Why a key of the configuration has no effect by this recipe, neither while a map is built nor while the
/// robot is localised in it; empty when it has one.
std::string whyInert(const PipelineParams& params, const std::string& section, const std::string& key);

/// Section and key of all that some configuration makes ineffective; no key: the whole section.
std::vector<std::pair<std::string, std::string>> ruledKeys();

/// Throws base::ConfigError with file and line, section, key and reason for the first key that was set and
/// has no effect. @param params as read from `ini`. @param origin looks at keys from there alone, as `--set`
void requireEffect(const base::IniFile& ini, const PipelineParams& params, const std::string& origin = "");

}  // namespace engram::pipeline
