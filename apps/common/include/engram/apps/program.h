// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/error.h"
#include "engram/base/output_file.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <initializer_list>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

namespace engram::apps {

/// Exit codes of all programs.
enum ExitCode : int {
  kOk = 0,
  kError = 1,    ///< bad input or a failure; nothing useful was made
  kUsage = 2,    ///< the command line cannot be understood
  kPartial = 3,  ///< stopped early (Ctrl-C, damaged input) or mostly in vain; what was done is kept
};

/// A command line that lacks something or contradicts itself: exit code 2.
class UsageError : public base::Error {
 public:
  using Error::Error;
};

/// A program as a class: main() is `return runProgram(program, argc, argv);`, and tests call it with their
/// own streams.
class Program {
 public:
  virtual ~Program() = default;
  virtual std::string name() const = 0;
  virtual std::string description() const = 0;
  virtual std::string examples() const = 0;
  /// Declares options; called once before parsing.
  virtual void declare(CLI::App& app) = 0;
  /// Does the work. `out` takes results, `err` progress and messages. Throws base::Error on bad input.
  virtual int run(std::ostream& out, std::ostream& err) = 0;

 protected:
  /// A message for the user, after the name of the program; nothing for an empty one.
  void say(const std::string& message, std::ostream& err) const;
};

/// A program of subcommands, each a program of its own.
class CommandProgram : public Program {
 public:
  std::string examples() const override;
  void declare(CLI::App& app) override;
  int run(std::ostream& out, std::ostream& err) override;

 protected:
  void add(std::unique_ptr<Program> command) { commands_.push_back(std::move(command)); }

 private:
  std::vector<std::unique_ptr<Program>> commands_;
  Program* chosen_ = nullptr;
};

/// Parses, runs, and turns exceptions into a message and an exit code. An option whose value is "-" takes
/// standard output; what `run` gets as `out` then goes to `err`.
///
/// For main(): a standard output that cannot be written is an error. When its reader has gone (`| head`) the
/// process ends by SIGPIPE, as other tools do, but not before everything in hand is closed.
int runProgram(Program& program, int argc, const char* const* argv);
/// Throws base::ClosedPipe when the reader of `out` has gone.
int runProgram(Program& program, const std::vector<std::string>& arguments, std::ostream& out,
               std::ostream& err);

/// The options of every program that has a configuration.
struct ConfigOptions {
  std::string file;
  std::vector<std::string> overrides;  ///< section.key=value
  bool dump = false;

  void declare(CLI::App& app);
};

/// Makes a folder for output, with its parents; an empty path makes none. Throws base::Error when it cannot
/// be made, or when one of the `files` cannot be written in it (base::requireWritable).
void makeFolder(const std::string& path, std::initializer_list<const char*> files = {});

/// base::requireWritable() whose message names the option of our programs, --overwrite.
void requireNew(const std::string& path, bool overwrite);

/// --json FILE, or - for standard output; does nothing with an empty path.
void writeJson(const std::string& path, const nlohmann::json& figures);

/// Largest resident memory of this process so far [byte].
std::uint64_t peakResidentBytes();

}  // namespace engram::apps
