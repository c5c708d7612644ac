// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/experiment.h"
#include "scans/scans_world.h"

namespace engram::apps {

/// engram-eval scans: the experiment of Bertolli, Jensfelt & Christensen (2006) on the simulator (V-10).
class ScansCommand final : public Experiment {
 public:
  std::string name() const override { return "scans"; }
  std::string description() const override;
  std::string examples() const override;

 private:
  void configure(base::Config& config) override;
  std::string identity() const override { return seedAndSize(); }
  std::vector<std::string> results() const override { return {"runs.csv", "sizes.csv", "index.html"}; }
  Findings measure(const Workplace& place, const std::string& settings) override;

  ScansWorldParams scans_;
  world::WorldParams world_;
  pipeline::PipelineParams pipeline_;
};

}  // namespace engram::apps
