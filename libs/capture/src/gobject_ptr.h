// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <arv.h>
#include <memory>
#include <string>

namespace engram::capture {

struct Unref {
  void operator()(void* object) const { g_object_unref(object); }
};
/// Owns one reference.
template <class T>
using GObjectPtr = std::unique_ptr<T, Unref>;

/// Takes the error of a call: `call(..., error.out())`.
class GErrorBox {
 public:
  GErrorBox() = default;
  ~GErrorBox() { g_clear_error(&error_); }
  GErrorBox(const GErrorBox&) = delete;
  GErrorBox& operator=(const GErrorBox&) = delete;

  GError** out() {
    g_clear_error(&error_);
    return &error_;
  }
  explicit operator bool() const { return error_ != nullptr; }
  std::string message() const { return error_ ? error_->message : ""; }
  bool is(int deviceError) const { return error_ && g_error_matches(error_, ARV_DEVICE_ERROR, deviceError); }

 private:
  GError* error_ = nullptr;
};

}  // namespace engram::capture
