// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/experiment_folder.h"
#include "tours/tours_lab.h"

#include <iosfwd>

namespace engram::apps {

/// engram-eval tours: the experiments of D-09 to D-11 on the simulator.
class ToursCommand {
 public:
  ToursCommand();
  void declare(CLI::App& command);
  int run(std::ostream& out, std::ostream& err);

 private:
  std::string readConfig();

  ExperimentOptions options_;
  ToursParams tours_;
  world::WorldParams world_;
  pipeline::PipelineParams pipeline_;
};

}  // namespace engram::apps
