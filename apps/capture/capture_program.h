// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/program.h"

namespace engram::apps {

/// engram-capture: GigE Vision cameras to rawlogs.
class CaptureProgram final : public CommandProgram {
 public:
  CaptureProgram();
  std::string name() const override { return "engram-capture"; }
  std::string description() const override;
};

}  // namespace engram::apps
