// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/sources/frame_source.h"

#include <memory>
#include <string>
#include <vector>

namespace engram::sources {

/// As a person sorts file names: runs of digits by their number, so IMG_9 comes before IMG_10.
bool naturalLess(const std::string& a, const std::string& b);

/// The image files of a folder (jpg, png, bmp, pgm, ppm, tif, webp), names only, sorted naturally.
/// Throws base::Error when the folder is missing or holds none.
std::vector<std::string> listImages(const std::string& folder);

/// The images of a folder as frames; without `csv` in natural order, stamped one second apart.
///
/// `csv` lists the frames instead. Its first line names the columns: `image` (file name relative to the
/// folder), and optionally `stamp` [s], `right` (right image of a stereo pair), `x`, `y` [m] and `yaw` [rad]
/// of odometry; the last three may be empty in a line. Lines that begin with # are comments.
///
/// Images that cannot be read, stamps that do not rise and odometry that is not a number are left out and
/// named in problem(). Throws base::Error for a bad folder or a bad line of the file.
std::unique_ptr<FrameSource> openImageFolder(const std::string& folder, const std::string& csv = {});

}  // namespace engram::sources
