// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/sources/frame_source.h"
#include "engram/sources/odometry_track.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace engram::sources {

/// An image to be delivered, with what is known of it.
struct ImageEntry {
  std::string image, right;  ///< paths; `right` empty for one camera
  std::string label;         ///< of the frame
  double stamp = 0.0;        ///< [s]
  std::optional<Pose2> pose;
};

/// The images of a list as frames. Those that cannot be read and stamps that do not rise are left out and
/// named in problem(), which begins with `name` and goes on with `notice` where there is one.
std::unique_ptr<FrameSource> makeListSource(std::string name, std::vector<ImageEntry> entries,
                                            std::string notice = {});

}  // namespace engram::sources
