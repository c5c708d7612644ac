// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/experiment_folder.h"
#include "memory/memory_report.h"
#include "memory/static_place.h"

#include <iosfwd>

namespace engram::apps {

/// engram-eval memory: the experiments of F-22 to F-31 on the simulator.
class MemoryCommand {
 public:
  void declare(CLI::App& command);
  int run(std::ostream& out, std::ostream& err);

 private:
  std::string readConfig();
  std::vector<Method> chosenMethods() const;
  void writeResults(const MemoryReport& report) const;

  ExperimentOptions options_;
  std::vector<std::string> methods_;  ///< --methods; none: all
  MemoryLabParams lab_;
  StaticPlaceParams staticPlace_;
  pipeline::PipelineParams pipeline_;
};

}  // namespace engram::apps
