// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <span>
#include <string>

namespace engram::sources {

/// Decodes an image file in memory (JPEG, PNG, …). Never throws, prints or ends the process, whatever the
/// bytes are; a size that no camera has is refused before it is decoded.
/// @param failure says why the image that is returned is empty.
/// @return 8 bit, 1 or 3 (BGR) channels
cv::Mat decodeImageBytes(std::span<const std::uint8_t> bytes, std::string& failure);

}  // namespace engram::sources
