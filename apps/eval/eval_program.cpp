// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval_program.h"

namespace engram::apps {

std::string EvalProgram::description() const {
  return "Repeats the papers' experiments and writes figures, tables and a report. An experiment that was "
         "interrupted goes on when the same command is given again.";
}

std::string EvalProgram::examples() const {
  return "  engram-eval memory --out lab --json lab.json\n"
         "  engram-eval memory --out lab_quick --quick\n"
         "  engram-eval memory --out lab_7 --seed 7 --set fsh.prune_view=3\n"
         "  engram-eval images --config config/fsh_mono.ini --reference day_left --query day_right "
         "--truth truth.csv --out gardens\n"
         "  engram-eval tours --out tours --json tours.json\n"
         "  engram-eval words --images walk --truth truth.csv --out loops --json loops.json\n"
         "  engram-eval words --out words --json words.json\n"
         "  engram-eval views --out views --json views.json\n"
         "  engram-eval odometry --rawlog office/session_01.rawlog --camera office/camera.ini --truth "
         "office/session_01.truth.tum --out vo\n";
}

void EvalProgram::declare(CLI::App& app) {
  app.require_subcommand(1);
  memory_.declare(*app.add_subcommand("memory",
                                      "How places remember: FSH, short- and long-term stores, bag of words, "
                                      "static, replace, over months of change"));
  imagesApp_ = app.add_subcommand("images", "The same memories on two real traversals of one way");
  images_.declare(*imagesApp_);
  toursApp_ = app.add_subcommand("tours", "Two months of tours: adaptive memories against a static one");
  tours_.declare(*toursApp_);
  wordsApp_ = app.add_subcommand(
      "words",
      "Maps and localisation by visual words and odometry, on the simulator; or, with --images, "
      "loop closures on images with ground truth");
  words_.declare(*wordsApp_);
  viewsApp_ = app.add_subcommand(
      "views", "Lifelong maps of stereo views: stitched drives, repair, fifty sessions, kappa");
  views_.declare(*viewsApp_);
  odometryApp_ = app.add_subcommand("odometry", "Visual odometry from a stereo camera, drift and time");
  odometry_.declare(*odometryApp_);
}

int EvalProgram::run(std::ostream& out, std::ostream& err) {
  if (toursApp_->parsed()) return tours_.run(out, err);
  if (wordsApp_->parsed()) return words_.run(out, err);
  if (viewsApp_->parsed()) return views_.run(out, err);
  if (odometryApp_->parsed()) return odometry_.run(out, err);
  return imagesApp_->parsed() ? images_.run(out, err) : memory_.run(out, err);
}

}  // namespace engram::apps
