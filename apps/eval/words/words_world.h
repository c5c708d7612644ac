// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/workplace.h"
#include "words/words_localisation.h"
#include "words/words_mapping.h"

#include <optional>
#include <string>
#include <vector>

namespace engram::apps {

/// Section `[words_world]`.
struct WordsWorldParams {
  int attempts = 100;         ///< at global localisation, for each setting and transition
  double right_within = 1.5;  ///< [m]

  void describe(base::Params& p);
};

/// A drive through a building of the simulator.
struct PlannedDrive {
  std::string name;
  std::string preset;
  double laps = 2;
  int day = 1;         ///< session of the world
  bool mapped = true;  ///< the mapping experiment is done with it
  std::string about;   ///< for the report
};

/// Where the robot locates itself: the first round of one drive is learnt, another pass is shown.
struct LocatedSetting {
  std::string name;
  std::string learnt, shown;  ///< names of drives; of one and the same, the rounds after the first are shown
  std::string about;          ///< for the report
};

/// What is done where.
struct WordsPlan {
  std::vector<PlannedDrive> drives;
  std::vector<LocatedSetting> settings;
};
/// @param quick one small building
const WordsPlan& wordsPlan(bool quick);

struct WordsWorldResult {
  std::vector<MappingRun> mapping;
  std::vector<LocalisationRun> localisation;
};

/// The experiments of Angeli et al. 2009 on the simulator: mapping and global localisation (A-21 to
///
class WordsWorld {
 public:
  /// @param world of all drives; its laps are those of the plan
  WordsWorld(const WordsPlan& plan, const WordsWorldParams& params, const world::WorldParams& world,
             const pipeline::PipelineParams& pipeline, Workplace place);

  /// Renders what is not rendered yet, and does what is not done yet. Throws base::Error for what cannot be
  /// used, base::Interrupted on Ctrl-C: what was done is kept.
  WordsWorldResult run();

 private:
  void recordDrives();
  MappingRun mapped(std::size_t drive) const;
  std::vector<LocalisationRun> located(const LocatedSetting& setting) const;
  const KeptDrive& driveOf(const std::string& name) const;
  std::string runFile(const std::string& name) const;

  WordsPlan plan_;
  WordsWorldParams params_;
  world::WorldParams world_;
  pipeline::PipelineParams pipeline_;
  Workplace place_;
  std::vector<KeptDrive> drives_;  ///< those of the plan
};

}  // namespace engram::apps
