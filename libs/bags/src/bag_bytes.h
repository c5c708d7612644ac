// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/error.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

namespace engram::bags {

using Bytes = std::vector<std::uint8_t>;

/// No record, chunk or message is larger; what states more is damaged. [bytes]
inline constexpr std::uint64_t kMaxBagRecord = std::uint64_t{1} << 29;

static_assert(std::endian::native == std::endian::little, "bags are read as they lie in the file");

/// Little-endian values from the front of some bytes; throws base::Error where they end.
class BagCursor {
 public:
  explicit BagCursor(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  bool atEnd() const { return rest_.empty(); }
  std::size_t left() const { return rest_.size(); }
  std::span<const std::uint8_t> take(std::uint64_t n) {
    if (n > rest_.size()) throw base::Error("a record is shorter than what it should hold");
    const auto out = rest_.first(static_cast<std::size_t>(n));
    rest_ = rest_.subspan(static_cast<std::size_t>(n));
    return out;
  }
  template <class T>
  T value() {
    T out;
    std::memcpy(&out, take(sizeof out).data(), sizeof out);
    return out;
  }
  /// A length of 32 bits and that many bytes.
  std::span<const std::uint8_t> sized() { return take(value<std::uint32_t>()); }
  std::string text() {
    const auto bytes = sized();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

 private:
  std::span<const std::uint8_t> rest_;
};

/// A file from its beginning; never takes more memory than the file has bytes.
class BagFile {
 public:
  explicit BagFile(const std::string& path) : in_(path, std::ios::binary) {
    std::error_code status;
    size_ = std::filesystem::file_size(path, status);
    if (status || !in_) throw base::Error(path + ": cannot be read");
  }
  std::uint64_t left() const { return size_ - at_; }
  double progress() const { return size_ > 0 ? static_cast<double>(at_) / static_cast<double>(size_) : 1.0; }
  std::uint64_t at() const { return at_; }
  Bytes take(std::uint64_t n) {
    if (n > left()) throw base::Error("the file ends in the middle of a record");
    if (n > kMaxBagRecord) throw base::Error("a record states " + std::to_string(n) + " bytes, too many");
    Bytes out(static_cast<std::size_t>(n));
    in_.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(n));
    if (!in_) throw base::Error("the file cannot be read further");
    at_ += n;
    return out;
  }
  void skip(std::uint64_t n) {
    if (n > left()) throw base::Error("the file ends in the middle of a record");
    in_.seekg(static_cast<std::streamoff>(n), std::ios::cur);
    at_ += n;
  }
  template <class T>
  T value() {
    const Bytes bytes = take(sizeof(T));
    T out;
    std::memcpy(&out, bytes.data(), sizeof out);
    return out;
  }

 private:
  std::ifstream in_;
  std::uint64_t size_ = 0, at_ = 0;
};

}  // namespace engram::bags
