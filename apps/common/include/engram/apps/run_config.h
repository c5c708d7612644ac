// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/offline_input.h"
#include "engram/apps/program.h"
#include "engram/base/held_text.h"
#include "engram/capture/live_config.h"
#include "engram/pipeline/params.h"
#include "engram/pipeline/recipe.h"
#include "engram/sources/rawlog_source.h"

#include <memory>
#include <string>
#include <vector>

namespace engram::apps {

/// The configuration that engram-slam and engram-localize share, with its command line options.
struct RunConfig {
  ConfigOptions options;
  std::string cameraFile;  ///< --camera
  pipeline::PipelineParams pipeline;
  sources::RawlogParams source;
  std::string liveSection;  ///< --live; empty: none
  std::vector<std::string> plugins;
  capture::LiveConfig live;

  void declare(CLI::App& app);
  /// True when --dump-config was served and the program is to stop.
  /// @param map whose own configuration and calibration serve where none is given; empty: there must be one
  bool load(std::ostream& out, const std::string& map = {});
  /// Settles which calibration is used: that of the command line; else that of the configuration, unless it
  /// is the simulator's; else that of the images; else the simulator's. To be called before a Pipeline is
  /// made. Throws base::Error when images of another size would be taken for the simulator's.
  /// @return what to tell the user; empty when nothing is out of the ordinary
  std::string settleCamera(OfflineInput& input);
  /// Every key in force, for the header of a map: equal for runs that give equal maps.
  std::string dumpForMap() const;
  /// What is allowed and not wise, in words; empty: nothing.
  std::string warning() const;

 private:
  void bind(base::Config& config);
  base::IniFile ofMap(const std::string& map);
  void holdCamera(const std::string& text, const std::string& name);
  void requireEffect(base::IniFile file) const;
  std::string dump(const base::Config& config) const;

  bool cameraGiven_ = false;                // on the command line, or by a map
  std::shared_ptr<base::HeldText> camera_;  // where no file is as the pipeline reads it
  std::string cameraName_;                  // what is held
};

}  // namespace engram::apps
