// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/program.h"
#include "engram/capture/grab_stats.h"
#include "engram/capture/live_config.h"

#include <memory>
#include <string>
#include <vector>

namespace engram::apps {

// The subcommands of engram-capture.
std::unique_ptr<Program> makeListCommand();
std::unique_ptr<Program> makeRecordCommand();
std::unique_ptr<Program> makeCheckCommand();
std::unique_ptr<Program> makePreviewCommand();
std::unique_ptr<Program> makeServeCommand();

/// Which camera, and how it is to be set: by a section of a configuration, by options, or both.
struct CameraOptions {
  std::string config, section, camera, rightCamera;
  std::vector<std::string> settings, features, plugins;

  void declare(CLI::App& app);
  /// Loads the plug-ins too. Throws base::Error.
  capture::LiveConfig load() const;
};

/// "640x480 Mono8, 30 images/s, Aravis Fake GV01 at 127.0.0.1".
std::string describe(const capture::CameraSettings& settings);

}  // namespace engram::apps
