// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/experiment.h"
#include "tours/room_lab.h"
#include "tours/tours_lab.h"

namespace engram::apps {

/// engram-eval tours: the experiments of D-09 to D-11 on the simulator.
class ToursCommand final : public Experiment {
 public:
  ToursCommand();
  std::string name() const override { return "tours"; }
  std::string description() const override;
  std::string examples() const override;

 private:
  void configure(base::Config& config) override;
  std::vector<std::string> results() const override { return {"tours.csv", "report.html"}; }
  Findings measure(const Workplace& place, const std::string& settings) override;

  ToursParams tours_;
  RoomParams room_;
  world::WorldParams world_;
  pipeline::PipelineParams pipeline_;
};

}  // namespace engram::apps
