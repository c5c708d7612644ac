// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/program.h"
#include "engram/capture/live_config.h"
#include "engram/pipeline/params.h"
#include "engram/pipeline/recipe.h"
#include "engram/sources/rawlog_source.h"

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
  bool load(std::ostream& out);
  /// Every key in force, for the header of a map: equal for runs that give equal maps.
  std::string dumpForMap() const;

 private:
  void bind(base::Config& config);
  void requireEffect(base::IniFile file) const;
  std::string dump(const base::Config& config) const;
};

}  // namespace engram::apps
