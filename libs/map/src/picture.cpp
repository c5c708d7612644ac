// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/map/picture.h"

#include "engram/base/image_header.h"

namespace engram::map {

std::string brokenPicture(std::span<const std::uint8_t> jpeg) {
  if (jpeg.size() < 2 || jpeg[0] != 0xff || jpeg[1] != 0xd8) return "it is not a JPEG";
  const auto size = base::sizeInHeader(jpeg);
  if (!size) return "its header is damaged";
  if (size->width == 0 || size->height == 0) return "it has no pixels";
  return base::plausibleSize(size->width, size->height) ? "" : "it has too many pixels";
}

}  // namespace engram::map
