// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/experiment.h"
#include "words/loop_benchmark.h"
#include "words/words_world.h"

#include <optional>
#include <string>

namespace engram::apps {

/// engram-eval words: loop closures by visual words. With --images, on any images with ground truth; without,
/// the experiments of Angeli et al. on the simulator.
class WordsCommand final : public Experiment {
 public:
  std::string name() const override { return "words"; }
  std::string description() const override;
  std::string examples() const override;

 private:
  void declareMore(CLI::App& command) override;
  void configure(base::Config& config) override;
  void adjust(const base::IniFile& ini) override;
  void check() override;
  std::string identity() const override;
  std::vector<std::string> results() const override;
  Findings measure(const Workplace& place, const std::string& settings) override;

  bool onImages() const { return !benchmark_.images.empty(); }
  void refuseImageOptions() const;
  Findings measureImages(const Workplace& place, const std::string& settings);
  Findings measureWorld(const Workplace& place, const std::string& settings);

  CLI::App* command_ = nullptr;
  LoopBenchmark benchmark_;
  std::string truthFile_;
  std::optional<evaluation::Truth> truth_;
  int margin_ = 0;
  WordsWorldParams words_;
  world::WorldParams world_;
  pipeline::PipelineParams pipeline_;
};

}  // namespace engram::apps
