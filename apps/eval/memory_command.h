// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiment_folder.h"
#include "memory_lab.h"

#include <iosfwd>

namespace engram::apps {

/// engram-eval memory: the experiments of F-22 to F-31 on the simulator.
class MemoryCommand {
 public:
  void declare(CLI::App& command);
  int run(std::ostream& out, std::ostream& err);

 private:
  std::string readConfig();

  ExperimentOptions options_;
  MemoryLabParams lab_;
  pipeline::PipelineParams pipeline_;
};

/// The memories that are compared (F-27, F-E21, D-13, F-31).
std::vector<Method> comparedMethods(const pipeline::PipelineParams& pipeline, int bowWords);
/// FSH with prune_view from 1 to 7 and with ltm_threshold from 0.1 to 0.9 (F-23).
std::vector<Method> sweptMethods(const pipeline::PipelineParams& pipeline);

}  // namespace engram::apps
