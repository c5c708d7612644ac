// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/experiment.h"
#include "views/views_world.h"

namespace engram::apps {

/// engram-eval views: the experiments of Konolige & Bowman (2009) on the simulator.
class ViewsCommand final : public Experiment {
 public:
  std::string name() const override { return "views"; }
  std::string description() const override;
  std::string examples() const override;

 private:
  void configure(base::Config& config) override;
  std::string identity() const override { return seedAndSize(); }
  std::vector<std::string> results() const override { return {"sessions.csv", "offsets.csv", "index.html"}; }
  Findings measure(const Workplace& place, const std::string& settings) override;

  ViewsWorldParams views_;
  world::WorldParams world_;
  pipeline::PipelineParams pipeline_;
};

}  // namespace engram::apps
