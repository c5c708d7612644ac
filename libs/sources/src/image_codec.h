// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/image_header.h"

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace engram::sources {

/// Larger images are taken for damage: they would need gigabytes.
using base::plausibleSize;

/// An image as it lies in a rawlog, not yet decoded: cheap to keep until its odometry is known.
struct EncodedImage {
  enum class Kind {
    kNone,         ///< an image of no pixels
    kFile,         ///< encoded as in an image file: JPEG, PNG, …
    kRaw,          ///< rows of pixels, `step` bytes each
    kDeflated,     ///< the same, compressed by zlib
    kExternal,     ///< in the file `path`
    kUnsupported,  ///< `path` holds the reason
  };
  Kind kind = Kind::kNone;
  cv::Size size;     ///< as declared; empty when not
  int channels = 3;  ///< of kRaw and kDeflated
  std::int64_t step = 0;
  bool bottomUp = false;
  std::vector<std::uint8_t> bytes;
  std::string path;
};

/// What became of decoding: an image, or the reason why there is none.
struct Decoded {
  cv::Mat image;  ///< 8 bit, 1 or 3 (BGR) channels; empty on failure
  std::string failure;
  bool missing = false;  ///< the external file does not exist
};

/// Never throws, prints or ends the process, whatever the bytes are.
/// @param folder where external images lie unless their path is absolute.
Decoded decode(const EncodedImage& image, const std::string& folder);

/// Reads an image file; rotation tags (EXIF) are ignored, as a calibration refers to the pixels as stored.
Decoded readImageFile(const std::string& path);

/// JPEG at `quality` 1 … 100.
std::vector<std::uint8_t> encodeJpeg(const cv::Mat& image, int quality);

}  // namespace engram::sources
