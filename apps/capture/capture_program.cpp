// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "capture_program.h"

#include "capture_command.h"

namespace engram::apps {

CaptureProgram::CaptureProgram() {
  add(makeListCommand());
  add(makeRecordCommand());
  add(makeCheckCommand());
  add(makePreviewCommand());
  add(makeServeCommand());
}

std::string CaptureProgram::description() const {
  return "Finds GigE Vision cameras, records them to MRPT rawlogs, and says what a recording is worth.";
}

}  // namespace engram::apps
