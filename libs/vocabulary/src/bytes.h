// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/error.h"
#include "engram/types/features.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>
#include <zlib.h>

namespace engram::vocabulary {

static_assert(std::endian::native == std::endian::little, "the format is little-endian");

class ByteWriter {
 public:
  template <class T>
  requires std::is_arithmetic_v<T>
  void put(T value) { raw(&value, sizeof value); }
  void raw(const void* data, std::size_t size) {
    const std::size_t old = bytes_.size();
    bytes_.resize(old + size);
    if (size > 0) std::memcpy(bytes_.data() + old, data, size);
  }
  void varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bytes_.push_back(static_cast<std::uint8_t>(value | 0x80));
    bytes_.push_back(static_cast<std::uint8_t>(value));
  }
  /// Appends the CRC-32 of all.
  std::vector<std::uint8_t> seal() && {
    put(static_cast<std::uint32_t>(crc32_z(0, bytes_.data(), bytes_.size())));
    return std::move(bytes_);
  }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Every method throws base::Error rather than read beyond the end.
class ByteReader {
 public:
  /// Checks the CRC-32 at the end.
  explicit ByteReader(std::span<const std::uint8_t> sealed) {
    std::uint32_t crc = 0;
    if (sealed.size() < sizeof crc) throw base::Error("it is too short");
    rest_ = sealed.first(sealed.size() - sizeof crc);
    std::memcpy(&crc, sealed.data() + rest_.size(), sizeof crc);
    if (crc != static_cast<std::uint32_t>(crc32_z(0, rest_.data(), rest_.size())))
      throw base::Error("its checksum is wrong");
  }

  template <class T>
  requires std::is_arithmetic_v<T> T get() {
    T value;
    raw(&value, sizeof value);
    return value;
  }
  void raw(void* data, std::size_t size) {
    if (size > rest_.size()) throw base::Error("it is too short");
    if (size > 0) std::memcpy(data, rest_.data(), size);
    rest_ = rest_.subspan(size);
  }
  /// Refuses numbers above `most`.
  std::uint64_t varint(std::uint64_t most) {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 63; shift += 7) {
      const auto byte = get<std::uint8_t>();
      value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
      if ((byte & 0x80) != 0) continue;
      if (value > most) break;
      return value;
    }
    throw base::Error("it holds a number that is too large");
  }
  /// A number of items that take at least `itemBytes` each: refused when there are too few bytes for them.
  std::size_t count(std::size_t itemBytes) {
    return static_cast<std::size_t>(varint(rest_.size() / itemBytes));
  }
  /// Refuses when fewer bytes are left: to be called before an allocation.
  void require(std::uint64_t size) const {
    if (size > rest_.size()) throw base::Error("it is too short");
  }
  void requireEnd() const {
    if (!rest_.empty()) throw base::Error("it is too long");
  }

 private:
  std::span<const std::uint8_t> rest_;
};

/// The most columns of descriptors that a file may claim.
inline constexpr std::uint64_t kMostDim = 65536;

/// @throws base::Error(problem) unless it holds
inline void require(bool holds, const char* problem) {
  if (!holds) throw base::Error(problem);
}

/// Numbers that are not finite have no distances, and what is sorted by them has no order.
inline void requireFinite(const types::Descriptors& d) {
  if (d.kind() != types::DescriptorKind::kFloat || d.empty()) return;
  const float* first = d.floats(0);
  const float* last = first + d.size() * static_cast<std::size_t>(d.dim());
  if (!std::all_of(first, last, [](float v) { return std::isfinite(v); }))
    throw base::Error("its descriptors are not finite");
}

}  // namespace engram::vocabulary
