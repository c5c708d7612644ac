// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/program.h"
#include "images/images_command.h"
#include "memory/memory_command.h"
#include "odometry/odometry_command.h"
#include "tours/tours_command.h"
#include "views/views_command.h"
#include "words/words_command.h"

namespace engram::apps {

/// engram-eval: the papers' experiments, on the simulator and on real images.
class EvalProgram : public Program {
 public:
  std::string name() const override { return "engram-eval"; }
  std::string description() const override;
  std::string examples() const override;
  void declare(CLI::App& app) override;
  int run(std::ostream& out, std::ostream& err) override;

 private:
  MemoryCommand memory_;
  ImagesCommand images_;
  CLI::App* imagesApp_ = nullptr;
  ToursCommand tours_;
  CLI::App* toursApp_ = nullptr;
  ViewsCommand views_;
  CLI::App* viewsApp_ = nullptr;
  WordsCommand words_;
  CLI::App* wordsApp_ = nullptr;
  OdometryCommand odometry_;
  CLI::App* odometryApp_ = nullptr;
};

}  // namespace engram::apps
