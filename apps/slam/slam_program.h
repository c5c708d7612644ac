// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/map_truth.h"
#include "engram/apps/program.h"
#include "engram/apps/run_config.h"
#include "engram/apps/run_input.h"
#include "engram/apps/run_stream.h"
#include "engram/apps/run_window.h"
#include "engram/pipeline/pipeline.h"
#include "engram/store/drive_writer.h"
#include "report_pictures.h"
#include "slam_figures.h"

#include <optional>
#include <string>

namespace engram::apps {

/// engram-slam: builds or extends a map from a rawlog or a live camera.
class SlamProgram : public Program {
 public:
  std::string name() const override { return "engram-slam"; }
  std::string description() const override;
  std::string examples() const override;
  void declare(CLI::App& app) override;
  int run(std::ostream& out, std::ostream& err) override;

 private:
  std::string mapPath() const;
  store::DriveWriter openMap(const std::string& path, std::ostream& err);
  map::MapHeader headerFor(const pipeline::Pipeline& mapper, const types::Frame& first) const;
  int conclude(store::MapFile& file, const pipeline::Pipeline& mapper, SlamFigures& figures,
               const MapTruth* truth, std::ostream& out, std::ostream& err);
  void writeReport(const store::MapFile& file, const map::TopologicalMap& map) const;

  RunConfig config_;
  RunInput input_;
  RunStream stream_;
  RunWindow window_;
  EyeWatch eyes_;
  ReportPictures pictures_;
  std::string notice_;  ///< of a map whose server went away
  std::string map_, report_, truth_, json_;
  double truthRadius_ = 2.0;
  int truthMargin_ = 0;
  store::DriveOptions drive_;
  bool quiet_ = false;
  bool acceptParameters_ = false;
};

}  // namespace engram::apps
