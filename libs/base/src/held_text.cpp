// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/held_text.h"

#include "engram/base/error.h"
#include "engram/base/output_file.h"

#include <cerrno>
#include <sys/mman.h>
#include <unistd.h>

namespace engram::base {

HeldText::HeldText(const std::string& text) : descriptor_(::memfd_create("engram", MFD_CLOEXEC)) {
  const int error = descriptor_ < 0 ? errno : writeAll(descriptor_, text);
  if (error == 0) return;
  if (descriptor_ >= 0) ::close(descriptor_);
  throw Error("a text cannot be held in memory: " + reasonOf(error));
}

HeldText::~HeldText() { ::close(descriptor_); }

}  // namespace engram::base
