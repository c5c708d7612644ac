// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/pipeline/params.h"
#include "engram/viewer/run_view.h"

#include <CLI/CLI.hpp>

#include <iosfwd>
#include <memory>
#include <string>

namespace engram::apps {

/// --view: a window on the run.
class RunWindow {
 public:
  void declare(CLI::App& app);
  /// @param map path of the map; what is saved is named after it
  void open(const pipeline::PipelineParams& params, const std::string& map, std::ostream& notices);
  /// To be called after each image; holds the run while the user pauses it.
  void after(const types::Frame& frame, const types::FrameReport& report, const map::TopologicalMap& map);

 private:
  void save(const map::TopologicalMap& map);

  bool wanted_ = false;
  std::string map_;
  std::unique_ptr<viewer::RunView> view_;
  std::ostream* notices_ = nullptr;
};

}  // namespace engram::apps
