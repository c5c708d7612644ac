// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/experiment_folder.h"

#include "engram/apps/checks.h"
#include "engram/apps/program.h"
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

namespace engram::apps {
namespace fs = std::filesystem;

void ExperimentOptions::declare(CLI::App& command) {
  command.add_option("--out", folder,
                     "Folder for results, report and intermediate files; the same command goes on in it");
  command.add_option("--json", json, "File for the final figures");
  command.add_option("--config", config, "Configuration (.ini); without it the protocol of the papers");
  command.add_option("--set", overrides, "Override one key: section.key=value (repeatable)")
      ->take_all()
      ->allow_extra_args(false);
  command.add_option("--seed", seed, "Seed of the building and of everything random")->capture_default_str();
  command.add_option("--threads", threads, "Threads, 0 for all cores; the figures do not depend on it")
      ->capture_default_str()
      ->check(wholeBetween(0, 256));
  command.add_flag("--quick", quick, "A small version that takes less than a minute");
  command.add_flag("--dump-config", dump, "Print every key in force with its meaning, and stop");
  command.add_flag("--overwrite", overwrite, "Remove results of other settings from the folder");
  command.add_flag("-q,--quiet", quiet, "No progress, no summary");
}

int ExperimentOptions::threadsInUse() const {
  return threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void claimFolder(const ExperimentOptions& options, const std::string& settings,
                 const std::vector<std::string>& results) {
  if (options.folder.empty()) throw UsageError("--out is needed: a folder for the results");
  base::requireWritable(options.json);
  makeFolder(options.folder);
  const fs::path folder = options.folder, file = folder / "experiment.ini";
  for (const auto& name : results) base::requireWritable((folder / name).string());
  if (fs::exists(file)) {
    std::ifstream in(file);
    std::ostringstream before;
    before << in.rdbuf();
    if (before.str() == settings) return;
    if (!options.overwrite)
      throw base::Error(options.folder +
                        " holds an experiment with other settings (see experiment.ini there); give another "
                        "folder, or --overwrite to remove its results");
    for (const char* made : {"runs", "sweeps", "static_place", "maps"}) fs::remove_all(folder / made);
  }
  base::writeText(file.string(), settings, true);
}

}  // namespace engram::apps
