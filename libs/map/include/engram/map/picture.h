// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace engram::map {

/// What is wrong with a stored JPEG picture as far as its header tells, in words; empty when all is well. To
/// be asked before it is decoded: a picture of a few hundred bytes may claim 65535 x 65535 pixels. Thumbnails
/// have far fewer than the 16 million that are let through.
std::string brokenPicture(std::span<const std::uint8_t> jpeg);

}  // namespace engram::map
