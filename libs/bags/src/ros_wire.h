// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bag_bytes.h"

namespace engram::bags {

/// The fields of a message one after another, as ROS 1 serialises them (packed) or as CDR (each value at a
/// multiple of its size, behind four bytes that tell the byte order). Throws base::Error where the bytes end.
class RosWire {
 public:
  RosWire(std::span<const std::uint8_t> data, bool cdr) : data_(data), cdr_(cdr) {
    if (!cdr) return;
    if (data.size() < 4 || data[0] != 0 || data[1] > 1) throw base::Error("a message is no plain CDR");
    swapped_ = data[1] == 0;
    data_ = data.subspan(4);
  }
  bool cdr() const { return cdr_; }

  template <class T>
  T value() {
    if (cdr_) at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    const auto bytes = take(sizeof(T));
    std::uint8_t ordered[sizeof(T)];
    std::copy(bytes.begin(), bytes.end(), ordered);
    if (swapped_) std::reverse(ordered, ordered + sizeof(T));
    T out;
    std::memcpy(&out, ordered, sizeof out);
    return out;
  }
  std::span<const std::uint8_t> bytes() { return take(value<std::uint32_t>()); }
  std::string text() {
    const auto raw = bytes();
    const std::string out(reinterpret_cast<const char*>(raw.data()), raw.size());
    return out.substr(0, out.find('\0'));  // CDR counts the zero at the end
  }
  std::vector<double> doubles(std::size_t n) {
    if (n > data_.size() / sizeof(double)) throw base::Error("a message is too short");
    std::vector<double> out(n);
    for (double& each : out) each = value<double>();
    return out;
  }

 private:
  std::span<const std::uint8_t> take(std::size_t n) {
    if (at_ > data_.size() || n > data_.size() - at_) throw base::Error("a message is too short");
    at_ += n;
    return data_.subspan(at_ - n, n);
  }

  std::span<const std::uint8_t> data_;
  std::size_t at_ = 0;
  bool cdr_, swapped_ = false;
};

}  // namespace engram::bags
