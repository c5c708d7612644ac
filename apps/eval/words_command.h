// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiment_folder.h"
#include "loop_benchmark.h"

#include <iosfwd>
#include <string>

namespace engram::apps {

/// engram-eval words: loop closures by visual words, on any images with ground truth.
class WordsCommand {
 public:
  WordsCommand();
  void declare(CLI::App& command);
  int run(std::ostream& out, std::ostream& err);

 private:
  std::string readConfig();
  int runImages(const std::string& settings, std::ostream& out, std::ostream& err);

  ExperimentOptions options_;
  LoopBenchmark benchmark_;
  std::string truthFile_;
  int margin_ = 0;
};

}  // namespace engram::apps
