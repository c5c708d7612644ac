// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

namespace engram::map {

/// A value that may still lie in a file: it is read when it is first asked for, and kept. Reading throws what
/// the source throws, and may then be tried again. Not for two threads at once, before it is here.
template <class T>
class OnDemand {
 public:
  /// Where values are read from, by number.
  class Source {
   public:
    virtual ~Source() = default;
    /// Throws base::Error when it cannot be read.
    virtual T read(std::uint32_t id) const = 0;
  };

  OnDemand() = default;
  OnDemand(T value) : value_(std::move(value)) {}
  OnDemand(std::shared_ptr<const Source> source, std::uint32_t id) : source_(std::move(source)), id_(id) {}

  bool isHere() const { return source_ == nullptr; }
  const T& operator*() const {
    if (source_ != nullptr) {
      value_ = source_->read(id_);
      source_ = nullptr;
    }
    return value_;
  }
  const T* operator->() const { return &**this; }
  operator const T&() const { return **this; }
  /// To change it.
  T& edit() { return const_cast<T&>(**this); }
  /// A copy of it, without keeping it here.
  T read() const { return source_ != nullptr ? source_->read(id_) : value_; }

 private:
  mutable T value_{};
  mutable std::shared_ptr<const Source> source_;  // none: the value is here
  std::uint32_t id_ = 0;
};

}  // namespace engram::map
