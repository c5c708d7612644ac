// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval_program.h"

#include "bench/bench_command.h"
#include "images/images_command.h"
#include "memory/memory_command.h"
#include "odometry/odometry_command.h"
#include "scans/scans_command.h"
#include "tours/tours_command.h"
#include "views/views_command.h"
#include "words/words_command.h"

namespace engram::apps {

EvalProgram::EvalProgram() {
  add(std::make_unique<MemoryCommand>());
  add(std::make_unique<ImagesCommand>());
  add(std::make_unique<ToursCommand>());
  add(std::make_unique<WordsCommand>());
  add(std::make_unique<ViewsCommand>());
  add(std::make_unique<ScansCommand>());
  add(std::make_unique<OdometryCommand>());
  add(std::make_unique<BenchCommand>());
}

std::string EvalProgram::description() const {
  return "Repeats the papers' experiments and writes figures, tables and a report. An experiment that was "
         "interrupted goes on when the same command is given again.";
}

}  // namespace engram::apps
