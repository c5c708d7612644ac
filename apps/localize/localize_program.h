// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/program.h"
#include "engram/apps/run_config.h"
#include "engram/apps/run_input.h"
#include "engram/apps/run_stream.h"
#include "engram/apps/run_window.h"
#include "engram/pipeline/pipeline.h"
#include "engram/store/drive_writer.h"
#include "localize_figures.h"

#include <optional>
#include <string>

namespace engram::apps {

/// engram-localize: says where the images of a rawlog or a live camera were taken in a map.
class LocalizeProgram : public Program {
 public:
  std::string name() const override { return "engram-localize"; }
  std::string description() const override;
  std::string examples() const override;
  void declare(CLI::App& app) override;
  int run(std::ostream& out, std::ostream& err) override;

 private:
  std::optional<store::DriveWriter> openToAdapt(std::ostream& err);
  pipeline::Pipeline open(store::DriveWriter* drive);
  int conclude(const pipeline::Pipeline& localizer, const LocalizeFigures& figures, std::ostream& out,
               std::ostream& err);

  RunConfig config_;
  RunInput input_;
  RunStream stream_;
  RunWindow window_;
  EyeWatch eyes_;
  std::optional<store::MapFile> frozen_;  // the map of a run that does not change it
  std::string map_, truth_, csv_, report_, json_;
  double truthRadius_ = 1.0;
  int truthMargin_ = 0;
  bool adapt_ = false, overwrite_ = false, quiet_ = false, global_ = false, resume_ = false, again_ = false;
  std::string notice_;  ///< of a map whose server went away
};

}  // namespace engram::apps
