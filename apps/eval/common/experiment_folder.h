// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace engram::apps {

/// What every experiment of engram-eval is asked with.
struct ExperimentOptions {
  std::string folder;                  ///< --out
  std::string json;                    ///< --json
  std::string config;                  ///< --config
  std::vector<std::string> overrides;  ///< --set
  std::uint64_t seed = 3;
  int threads = 0;  ///< 0: one for each core
  bool quick = false, dump = false, overwrite = false, quiet = false;

  void declare(CLI::App& command);
  int threadsInUse() const;
};

/// Claims a folder for one experiment. What an earlier run with the same settings left there is used again;
/// the settings are kept in `experiment.ini` in it. Throws base::Error when the folder holds results of other
/// settings and `overwrite` is false; with it, the results of that experiment are removed. Throws it too when
/// one of the files `results` cannot be written there.
void claimFolder(const ExperimentOptions& options, const std::string& settings,
                 const std::vector<std::string>& results);

}  // namespace engram::apps
