// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/program.h"

#include <memory>
#include <string>
#include <utility>

namespace engram::apps {

/// Options that all subcommands have.
struct CommonOptions {
  bool quiet = false;
  std::string json;

  void declare(CLI::App& app);
  /// Where progress goes: nowhere with -q.
  std::ostream* progressTo(std::ostream& err) const { return quiet ? nullptr : &err; }
};

std::unique_ptr<Program> makePackCommand();
std::unique_ptr<Program> makeImportCommand();
std::unique_ptr<Program> makeInfoCommand();
std::unique_ptr<Program> makeUnpackCommand();
std::unique_ptr<Program> makeCalibrateCommand();

/// engram-rawlog: image folders to rawlogs and back, ROS bags to rawlogs, what is in a rawlog, camera
/// calibration.
class RawlogProgram final : public CommandProgram {
 public:
  RawlogProgram();
  std::string name() const override { return "engram-rawlog"; }
  std::string description() const override;
};

/// Ctrl-C or lost input makes a result partial; `problem` and the reason go to `err`.
int finish(const std::string& problem, bool whole, bool interrupted, std::ostream& err);

/// "640x480"; throws base::Error naming `option`.
std::pair<int, int> parseSize(const std::string& text, const std::string& option);

}  // namespace engram::apps
