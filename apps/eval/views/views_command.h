// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/experiment_folder.h"
#include "views/views_world.h"

#include <iosfwd>
#include <string>

namespace engram::apps {

/// engram-eval views: the experiments of Konolige & Bowman (2009) on the simulator.
class ViewsCommand {
 public:
  void declare(CLI::App& command);
  int run(std::ostream& out, std::ostream& err);

 private:
  std::string readConfig();
  void writeResults(const ViewsResult& result, const std::string& settings) const;

  ExperimentOptions options_;
  ViewsWorldParams views_;
  world::WorldParams world_;
  pipeline::PipelineParams pipeline_;
};

}  // namespace engram::apps
