// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/line_file.h"

#include "engram/base/error.h"

#include <cerrno>
#include <cstring>

namespace engram::base {

void LineFile::add(const std::string& line) {
  if (!wanted() || !failure_.empty()) return;
  errno = 0;
  const auto reason = [] { return std::string(std::strerror(errno != 0 ? errno : EIO)); };
  if (!out_.is_open()) out_.open(path_, std::ios::binary);
  if (!out_.is_open()) throw Error("cannot write '" + path_ + "': " + reason());
  out_ << line << '\n' << std::flush;
  if (!out_) failure_ = "'" + path_ + "' lacks lines: " + reason();
}

}  // namespace engram::base
