// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/program.h"

#include "engram/apps/json_file.h"
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/text.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sys/resource.h>
#include <unistd.h>

namespace engram::apps {

int runProgram(Program& program, const std::vector<std::string>& arguments, std::ostream& out,
               std::ostream& err) {
  CLI::App app(program.description(), program.name());
  app.footer("Examples:\n" + program.examples() +
             "\nExit codes: 0 ok, 1 error, 2 usage, 3 stopped early, what was done is kept.");
  program.declare(app);
  try {
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    app.parse(reversed);
  } catch (const CLI::ParseError& e) {
    return app.exit(e, out, err) == 0 ? kOk : kUsage;
  }
  try {
    return program.run(out, err);
  } catch (const base::Interrupted& e) {
    err << program.name() << ": " << base::forTerminal(e.what())
        << "; what was done is kept, and the same command goes on from there\n";
    return kPartial;
  } catch (const std::exception& e) {
    err << program.name() << ": " << base::forTerminal(e.what()) << "\n";
    return kError;
  }
}

int runProgram(Program& program, int argc, const char* const* argv) {
  base::installInterruptHandler();
  return runProgram(program, std::vector<std::string>(argv + 1, argv + argc), std::cout, std::cerr);
}

std::string CommandProgram::examples() const {
  std::string text;
  for (const auto& command : commands_) text += command->examples();
  return text;
}

void CommandProgram::declare(CLI::App& app) {
  app.require_subcommand(1);
  for (auto& command : commands_) {
    CLI::App* sub = app.add_subcommand(command->name(), command->description());
    sub->footer("Examples:\n" + command->examples());
    command->declare(*sub);
    sub->callback([this, at = command.get()] { chosen_ = at; });
  }
}

int CommandProgram::run(std::ostream& out, std::ostream& err) { return chosen_->run(out, err); }

void ConfigOptions::declare(CLI::App& app) {
  app.add_option("config", file, "Configuration (.ini); see the folder config/")->required();
  app.add_option("--set", overrides, "Override one key: section.key=value (repeatable)")
      ->take_all()
      ->allow_extra_args(false);
  app.add_flag("--dump-config", dump, "Print every key in force with its meaning, and stop");
}

void requireFolderOf(const std::string& path) {
  const auto folder = std::filesystem::path(path).parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder))
    throw base::Error(path + ": cannot be written: there is no folder " + folder.string());
}

void makeFolder(const std::string& path) {
  if (path.empty()) return;
  std::error_code status;
  std::filesystem::create_directories(path, status);
  if (status) throw base::Error(path + ": the folder cannot be made (" + status.message() + ")");
}

void writeJson(const std::string& path, const nlohmann::json& figures) {
  if (!path.empty()) base::writeText(path, toText(figures, 2) + "\n", true);
}

std::uint64_t peakResidentBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024u;
}

}  // namespace engram::apps
