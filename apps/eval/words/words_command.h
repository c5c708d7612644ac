// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/experiment_folder.h"
#include "words/loop_benchmark.h"
#include "words/words_world.h"

#include <iosfwd>
#include <string>

namespace engram::apps {

/// engram-eval words: loop closures by visual words. With --images, on any images with ground truth; without,
/// the experiments of Angeli et al. on the simulator.
class WordsCommand {
 public:
  void declare(CLI::App& command);
  int run(std::ostream& out, std::ostream& err);

 private:
  bool onImages() const { return !benchmark_.images.empty(); }
  void refuseImageOptions() const;
  std::string readConfig();
  int runImages(const std::string& settings, std::ostream& out, std::ostream& err);
  int runWorld(const std::string& settings, std::ostream& out, std::ostream& err);
  void writeResults(const WordsWorldResult& result, const std::string& settings) const;

  CLI::App* command_ = nullptr;
  ExperimentOptions options_;
  LoopBenchmark benchmark_;
  std::string truthFile_;
  int margin_ = 0;
  WordsWorldParams words_;
  world::WorldParams world_;
  pipeline::PipelineParams pipeline_;
};

}  // namespace engram::apps
