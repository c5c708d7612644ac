// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/run_window.h"

#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/exporters/exporters.h"

#include <cstdio>
#include <filesystem>
#include <ostream>

namespace engram::apps {

void RunWindow::declare(CLI::App& app) {
  app.add_flag(
      "--view", wanted_,
      "Show the run in a window: map, image, belief; space pauses, n steps, s saves picture and scene beside "
      "the map");
}

void RunWindow::open(const pipeline::PipelineParams& params, const std::string& map, std::ostream& notices) {
  if (!wanted_) return;
  map_ = map;
  notices_ = &notices;
  view_ =
      std::make_unique<viewer::RunView>(params, "Engram: " + std::filesystem::path(map).filename().string());
}

void RunWindow::after(const types::Frame& frame, const types::FrameReport& report,
                      const map::TopologicalMap& map) {
  if (!view_) return;
  view_->show(frame, report, map);
  while (view_->wish([] { return base::interrupted(); }) == viewer::RunView::Wish::kSave) save(map);
  if (!view_->closed()) return;
  view_.reset();
  *notices_ << "the window was closed; the run goes on\n" << std::flush;
}

void RunWindow::save(const map::TopologicalMap& map) {
  std::string name;
  for (int n = 1; name.empty() || std::filesystem::exists(name + ".png"); ++n) {
    char number[32];
    std::snprintf(number, sizeof number, "_view_%03d", n);
    name = std::filesystem::path(map_).replace_extension().string() + number;
  }
  try {
    view_->savePicture(name + ".png");
    exporters::writeScene(name + ".3Dscene", map, {.images = true, .overwrite = true});
    *notices_ << "saved " << name << ".png and .3Dscene\n" << std::flush;
  } catch (const base::Error& e) {
    *notices_ << e.what() << "\n" << std::flush;
  }
}

}  // namespace engram::apps
