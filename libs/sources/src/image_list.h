// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/sources/image_folder_source.h"
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

/// What is known of a list before its images are read.
struct ImageListNotes {
  std::string problem;   ///< the beginning of problem()
  StampReading reading;  ///< for stampReading()
};

/// The images of a list as frames. Those that cannot be read and stamps that no reader of rawlogs accepts are
/// left out and named in problem(), which begins with `name`.
std::unique_ptr<ImageListSource> makeListSource(std::string name, std::vector<ImageEntry> entries,
                                                ImageListNotes notes = {});

/// Sets the stamps [s] of a list from their text.
/// Throws base::Error for a text that is no finite number.
/// @param written one for each entry
/// @param unit kAuto to tell it from the stamps
StampReading setStamps(std::vector<ImageEntry>& entries, const std::vector<std::string>& written,
                       StampUnit unit);

}  // namespace engram::sources
