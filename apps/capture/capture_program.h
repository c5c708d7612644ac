// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "capture_command.h"

namespace engram::apps {

/// engram-capture: GigE Vision cameras to rawlogs.
class CaptureProgram final : public Program {
 public:
  CaptureProgram();
  std::string name() const override { return "engram-capture"; }
  std::string description() const override;
  std::string examples() const override;
  void declare(CLI::App& app) override;
  int run(std::ostream& out, std::ostream& err) override;

 private:
  std::vector<std::unique_ptr<CaptureCommand>> commands_;
  CaptureCommand* chosen_ = nullptr;
};

}  // namespace engram::apps
