// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "capture_program.h"

namespace engram::apps {

CaptureProgram::CaptureProgram() {
  commands_.push_back(makeListCommand());
  commands_.push_back(makeRecordCommand());
  commands_.push_back(makeCheckCommand());
  commands_.push_back(makePreviewCommand());
  commands_.push_back(makeServeCommand());
}

std::string CaptureProgram::description() const {
  return "Finds GigE Vision cameras, records them to MRPT rawlogs, and says what a recording is worth.";
}

std::string CaptureProgram::examples() const {
  std::string text;
  for (const auto& command : commands_) text += command->examples();
  return text;
}

void CaptureProgram::declare(CLI::App& app) {
  app.require_subcommand(1);
  for (auto& command : commands_) {
    CLI::App* sub = app.add_subcommand(command->name(), command->description());
    sub->footer("Examples:\n" + command->examples());
    command->declare(*sub);
    sub->callback([this, at = command.get()] { chosen_ = at; });
  }
}

int CaptureProgram::run(std::ostream& out, std::ostream& err) { return chosen_->run(out, err); }

}  // namespace engram::apps
