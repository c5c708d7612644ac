// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/line_file.h"

#include "engram/base/output_file.h"

#include <cerrno>
#include <unistd.h>

namespace engram::base {

LineFile::~LineFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void LineFile::add(const std::string& line) {
  if (!wanted() || !failure_.empty()) return;
  if (descriptor_ < 0) descriptor_ = openOutput(path_);
  const int error = writeAll(descriptor_, line + '\n');
  if (error == EPIPE && path_ == kStandardOutput) throw ClosedPipe();
  if (error != 0) failure_ = "'" + path_ + "' lacks lines: " + reasonOf(error);
}

}  // namespace engram::base
