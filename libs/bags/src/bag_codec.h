// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bag_bytes.h"

namespace engram::bags {

/// The bytes of a chunk.
/// @param compression "", "none", "bz2", "lz4" (frames) or "zstd"
/// @param size of the result as stated [bytes]; memory grows with what there is, not with what is stated.
/// Throws base::Error for damage, another size, and a compression that is not known.
Bytes decompressChunk(const std::string& compression, std::span<const std::uint8_t> bytes,
                      std::uint64_t size);

/// A message that was compressed by itself (ROS 2, compression mode `message`); others pass as they are.
Bytes decompressMessage(Bytes bytes);

}  // namespace engram::bags
