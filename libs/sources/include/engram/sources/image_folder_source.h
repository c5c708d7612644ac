// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/sources/frame_source.h"
#include "engram/sources/stamp_unit.h"

#include <memory>
#include <string>
#include <vector>

namespace engram::sources {

/// As a person sorts file names: runs of digits by their number, so IMG_9 comes before IMG_10.
bool naturalLess(const std::string& a, const std::string& b);

/// Whether a name ends like that of an image file (jpg, png, bmp, pgm, ppm, tif, webp).
bool isImageName(const std::string& name);

/// The image files of a folder (jpg, png, bmp, pgm, ppm, tif, webp), names only, sorted naturally.
/// Throws base::Error when the folder is missing or holds none.
std::vector<std::string> listImages(const std::string& folder);

/// The frames of image files.
class ImageListSource : public FrameSource {
 public:
  /// The unit of the stamps; kAuto when none were given.
  virtual StampReading stampReading() const = 0;
  /// That the clock was set while the images were taken, as a sentence for the user; else empty. Known at the
  /// end.
  virtual std::string clockNote() const = 0;
};

/// The images of a folder as frames; without `csv` in natural order, stamped one second apart.
///
/// `csv` lists the frames instead. Its first line names the columns: `image` (file name relative to the
/// folder), and optionally `stamp` [`unit`], `right` (right image of a stereo pair), `x`, `y` [m] and `yaw`
/// [rad] of odometry; the last three may be empty in a line. Lines that begin with # are comments.
///
/// Images that cannot be read, stamps that do not rise (but where the clock was set for good) and odometry
/// that is not a number are left out and named in problem(). A rawlog of the frames holds no stamp that its
/// reader refuses. Throws base::Error for a bad folder or a bad line of the file.
std::unique_ptr<ImageListSource> openImageFolder(const std::string& folder, const std::string& csv = {},
                                                 StampUnit unit = StampUnit::kAuto);

}  // namespace engram::sources
