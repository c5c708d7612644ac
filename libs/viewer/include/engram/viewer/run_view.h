// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"
#include "engram/pipeline/params.h"
#include "engram/types/frame.h"
#include "engram/types/frame_report.h"

#include <functional>
#include <memory>
#include <string>

namespace engram::viewer {

/// A window on a run: the growing map, the image at hand with its features, the belief, the matched view, the
/// state; with pause (space), step (right arrow, or n) and save (s). It lives in a thread of its own and asks
/// for a picture a few times a second at most, so that the run hardly notices.
class RunView {
 public:
  /// Throws base::Error when there is no display, or none that can draw.
  RunView(const pipeline::PipelineParams& params, const std::string& title);
  ~RunView();
  RunView(const RunView&) = delete;
  RunView& operator=(const RunView&) = delete;

  /// To be called after each image. Cheap, unless the window asks for a new picture.
  void show(const types::Frame& frame, const types::FrameReport& report, const map::TopologicalMap& map);
  enum class Wish {
    kGoOn,  ///< to the next image
    kSave,  ///< save now, then ask again
  };
  /// What the user wants before the next image; waits during a pause. @param stopped ends the pause
  Wish wish(const std::function<bool()>& stopped);

  /// Writes what the panel shows. Throws base::Error when that cannot be done.
  void savePicture(const std::string& path) const;

  /// The user has closed the window; the run goes on without.
  bool closed() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace engram::viewer
