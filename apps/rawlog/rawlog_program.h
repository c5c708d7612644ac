// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/program.h"

#include <memory>
#include <vector>

namespace engram::apps {

/// A subcommand of engram-rawlog.
class RawlogCommand {
 public:
  virtual ~RawlogCommand() = default;
  virtual std::string name() const = 0;
  virtual std::string description() const = 0;
  virtual std::string examples() const = 0;
  virtual void declare(CLI::App& app) = 0;
  virtual int run(std::ostream& out, std::ostream& err) = 0;
};

/// Options that all subcommands have.
struct CommonOptions {
  bool quiet = false;
  std::string json;

  void declare(CLI::App& app);
  /// Where progress goes: nowhere with -q.
  std::ostream* progressTo(std::ostream& err) const { return quiet ? nullptr : &err; }
};

std::unique_ptr<RawlogCommand> makePackCommand();
std::unique_ptr<RawlogCommand> makeInfoCommand();
std::unique_ptr<RawlogCommand> makeUnpackCommand();
std::unique_ptr<RawlogCommand> makeCalibrateCommand();

/// engram-rawlog: image folders to rawlogs and back, what is in a rawlog, camera calibration.
class RawlogProgram final : public Program {
 public:
  RawlogProgram();
  std::string name() const override { return "engram-rawlog"; }
  std::string description() const override;
  std::string examples() const override;
  void declare(CLI::App& app) override;
  int run(std::ostream& out, std::ostream& err) override;

 private:
  std::vector<std::unique_ptr<RawlogCommand>> commands_;
  RawlogCommand* chosen_ = nullptr;
};

/// Ctrl-C or lost input makes a result partial; `problem` and the reason go to `err`.
int finish(const std::string& problem, bool whole, bool interrupted, std::ostream& err);

/// "640x480"; throws base::Error naming `option`.
std::pair<int, int> parseSize(const std::string& text, const std::string& option);

}  // namespace engram::apps
