// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace engram::base {

/// A text in memory that has a path in this process, for readers that take files. Nothing is left on the
/// disk.
class HeldText {
 public:
  /// Throws base::Error when the system has no memory for it.
  explicit HeldText(const std::string& text);
  ~HeldText();
  HeldText(const HeldText&) = delete;
  HeldText& operator=(const HeldText&) = delete;

  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_ = -1;
};

}  // namespace engram::base
