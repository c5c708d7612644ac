// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/experiment.h"
#include "memory/memory_report.h"
#include "memory/static_place.h"

namespace engram::apps {

/// engram-eval memory: the experiments of F-22 to F-31 on the simulator.
class MemoryCommand final : public Experiment {
 public:
  std::string name() const override { return "memory"; }
  std::string description() const override;
  std::string examples() const override;

 private:
  void declareMore(CLI::App& command) override;
  void configure(base::Config& config) override;
  void check() override;
  std::vector<std::string> results() const override { return {"results.csv", "sweeps.csv", "report.html"}; }
  Findings measure(const Workplace& place, const std::string& settings) override;

  std::vector<std::string> names_;  ///< --methods; none: all
  std::vector<Method> methods_;
  MemoryLabParams lab_;
  StaticPlaceParams staticPlace_;
  pipeline::PipelineParams pipeline_;
};

}  // namespace engram::apps
