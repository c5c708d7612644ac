// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/store/drive.h"

#include "blob.h"
#include "engram/base/text.h"

#include <vector>

namespace engram::store {
namespace {

void append(std::vector<std::uint8_t>& bytes, const void* data, std::size_t size) {
  const auto* begin = static_cast<const std::uint8_t*>(data);
  bytes.insert(bytes.end(), begin, begin + size);
}

}  // namespace

std::uint32_t fingerprintOf(const types::Frame& first) {
  std::vector<std::uint8_t> bytes;
  append(bytes, &first.stamp, sizeof first.stamp);
  for (int row = 0; row < first.image.rows; ++row)
    append(bytes, first.image.ptr(row), static_cast<std::size_t>(first.image.cols) * first.image.elemSize());
  return crc32Of(bytes);
}

std::string describe(const Drive& drive) {
  return "drive " + std::to_string(drive.id) + " ('" + drive.source + "', " +
         base::counted(drive.images, "image") + ")";
}

}  // namespace engram::store
