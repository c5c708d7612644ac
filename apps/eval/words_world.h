// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "words_localisation.h"
#include "words_mapping.h"

#include <iosfwd>
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

/// A drive that is mapped.
struct MappedBuilding {
  std::string name;
  std::string preset;
  double laps = 2;
  std::string about;  ///< for the report
};

/// A drive in which the robot locates itself: its first round is learnt, the second one is shown.
struct LocatedSetting {
  std::string name;
  std::string building;  ///< of the mapped ones
  std::string about;     ///< for the report
};

/// What is done where.
struct WordsPlan {
  std::vector<MappedBuilding> buildings;
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
  struct Options {
    std::string folder;
    int threads = 1;
    std::ostream* progress = nullptr;
  };

  /// @param world of all buildings; its laps are those of the plan
  WordsWorld(const WordsPlan& plan, const WordsWorldParams& params, const world::WorldParams& world,
             const pipeline::PipelineParams& pipeline, Options options);

  /// Renders what is not rendered yet, and does what is not done yet. Throws base::Error for what cannot be
  /// used, base::Interrupted on Ctrl-C: what was done is kept.
  WordsWorldResult run();

 private:
  void recordDrives();
  MappingRun mapped(const MappedBuilding& building, const KeptDrive& drive) const;
  std::vector<LocalisationRun> located(const LocatedSetting& setting, const KeptDrive& drive) const;
  const KeptDrive& driveOf(const std::string& building) const;
  std::string runFile(const std::string& name) const;

  WordsPlan plan_;
  WordsWorldParams params_;
  world::WorldParams world_;
  pipeline::PipelineParams pipeline_;
  Options options_;
  std::vector<KeptDrive> drives_;  ///< of the buildings of the plan
};

}  // namespace engram::apps
