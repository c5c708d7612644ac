// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace engram::capture {

/// How many bits a pixel of this format takes, by the GenICam Pixel Format Naming Convention (PFNC).
int bitsPerPixel(std::uint32_t pfnc);

/// Whether toImage() knows the format: Mono8, Mono10, Mono12, Mono16, Bayer (GR, RG, GB, BG) of 8 bits, RGB8,
/// BGR8.
bool isSupported(std::uint32_t pfnc);

/// The names of these formats, for messages.
std::string supportedFormats();

/// The pixels of a buffer as an 8 bit image of 1 or 3 (BGR) channels; a copy. More than 8 bits lose their
/// lowest ones; Bayer patterns are interpolated bilinearly.
/// @param rowPadding bytes after each row
/// Throws base::Error when the format is not supported or the bytes are fewer than the size needs.
cv::Mat toImage(std::span<const std::uint8_t> bytes, cv::Size size, std::uint32_t pfnc, int rowPadding = 0);

}  // namespace engram::capture
