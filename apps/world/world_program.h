// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "data_set.h"
#include "engram/apps/program.h"

#include <optional>
#include <string>
#include <vector>

namespace engram::apps {

/// engram-world: makes data sets of simulated buildings.
class WorldProgram : public Program {
 public:
  std::string name() const override { return "engram-world"; }
  std::string description() const override;
  std::string examples() const override;
  void declare(CLI::App& app) override;
  int run(std::ostream& out, std::ostream& err) override;

 private:
  void declareCommon(CLI::App& command);
  void readConfig();
  world::Plan plan() const;
  world::Eyes eyes() const;
  int make(std::ostream& out, std::ostream& err);
  int render(std::ostream& out);
  int showPlan(std::ostream& out);

  CLI::App *make_ = nullptr, *render_ = nullptr, *plan_ = nullptr;
  std::string preset_ = "office", planFile_, camera_ = "omni", config_, json_, out_, pose_ = "";
  std::vector<std::string> overrides_;
  bool dump_ = false, quiet_ = false;
  int threads_ = 1, session_ = 1;
  std::optional<double> spacing_;
  world::WorldParams params_;
  DataSetOptions dataSet_;
};

}  // namespace engram::apps
