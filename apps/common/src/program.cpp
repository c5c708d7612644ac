// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/program.h"

#include "engram/apps/json_file.h"
#include "engram/apps/standard_output.h"
#include "engram/base/atomic_file.h"
#include "engram/base/config.h"
#include "engram/base/interrupt.h"
#include "engram/base/standard_descriptors.h"
#include "engram/base/text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <sys/resource.h>

namespace engram::apps {
namespace {

/// How many options of the command line send their output to standard output.
std::size_t countStandardOutputs(const CLI::App& app) {
  std::size_t n = 0;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& value : option->results())
      n += !option->get_positional() && value == base::kStandardOutput;
  for (const CLI::App* command : app.get_subcommands()) n += countStandardOutputs(*command);
  return n;
}

bool asks(const CLI::App& app, const std::string& name) {
  const CLI::Option* option = app.get_option_no_throw(name);
  if (option != nullptr && option->count() > 0) return true;
  const auto commands = app.get_subcommands();
  return std::any_of(commands.begin(), commands.end(), [&](const CLI::App* c) { return asks(*c, name); });
}

/// Where results for people go: aside, when an output for programs takes standard output.
std::ostream& summaryTo(const CLI::App& app, std::ostream& out, std::ostream& err) {
  const std::size_t claims = asks(app, "--dump-config") ? 0 : countStandardOutputs(app);
  if (claims > 1) throw UsageError("two outputs are to go to standard output (-); give one of them a file");
  return claims > 0 ? err : out;
}

/// The options that the user could have meant.
std::vector<std::string> optionNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const CLI::App* command : app.get_subcommands())
    for (auto& name : optionNames(*command)) names.push_back(std::move(name));
  return names;
}

/// What was not understood, in the order of the command line, each with what it resembles.
std::string describeExtras(const CLI::App& app, const std::vector<std::string>& arguments) {
  const auto extras = app.remaining(true);
  const auto known = optionNames(app);
  std::string text;
  for (const auto& word : arguments) {
    const std::string option = word.substr(0, word.find('='));
    if (std::none_of(extras.begin(), extras.end(),
                     [&](const std::string& e) { return e == word || e == option; }))
      continue;
    const std::string nearest = base::nearestName(option, known);
    text += (text.empty() ? "" : "; ") + std::string("not understood: ") + base::quoted(word);
    if (!nearest.empty() && option.starts_with("-")) text += ", did you mean " + nearest + "?";
  }
  return text.empty() ? "not understood: " + CLI::detail::join(extras, " ") : text;
}

int parseAndRun(Program& program, const std::vector<std::string>& arguments, std::ostream& out,
                std::ostream& err) {
  CLI::App app(program.description(), program.name());
  app.footer("Examples:\n" + program.examples() +
             "\nExit codes: 0 ok, 1 error, 2 usage, 3 stopped early, what was done is kept.");
  app.set_help_all_flag("--help-all", "Print this and the help of all subcommands, and exit");
  app.set_version_flag("--version", program.name() + " (Engram) " ENGRAM_VERSION,
                       "Print the version and exit");
  program.declare(app);
  try {
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    app.parse(reversed);
  } catch (const CLI::ExtrasError&) {
    throw UsageError(describeExtras(app, arguments));
  } catch (const CLI::ParseError& e) {
    return app.exit(e, out, err) == 0 ? kOk : kUsage;
  }
  return program.run(summaryTo(app, out, err), err);
}

}  // namespace

int runProgram(Program& program, const std::vector<std::string>& arguments, std::ostream& out,
               std::ostream& err) {
  try {
    const int code = parseAndRun(program, arguments, out, err);
    out.flush();
    return code;
  } catch (const base::Interrupted& e) {
    err << program.name() << ": " << base::forTerminal(e.what())
        << "; what was done is kept, and the same command goes on from there\n";
    return kPartial;
  } catch (const UsageError& e) {
    err << program.name() << ": " << e.what() << "\nRun with --help for more information.\n";
    return kUsage;
  } catch (const base::ClosedPipe&) {
    throw;
  } catch (const std::exception& e) {
    err << program.name() << ": " << base::forTerminal(e.what()) << "\n";
    return kError;
  }
}

int runProgram(Program& program, int argc, const char* const* argv) {
  base::openStandardDescriptors();
  base::installInterruptHandler();
  // The writes fail instead, in the middle of no file.
  const auto onClosedPipe = std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  StandardOutput out;
  try {
    return runProgram(program, std::vector<std::string>(argv + 1, argv + argc), out, std::cerr);
  } catch (const base::ClosedPipe& e) {
    if (onClosedPipe == SIG_DFL) {  // quiet, as other tools end before `| head`
      std::signal(SIGPIPE, SIG_DFL);
      std::raise(SIGPIPE);
    }
    std::cerr << program.name() << ": " << e.what() << "\n";
    return kError;
  }
}

void Program::say(const std::string& message, std::ostream& err) const {
  if (!message.empty()) err << name() << ": " << message << "\n" << std::flush;
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
  app.add_option("config", file, "Configuration: a file (.ini), or a name such as fsh_omni");
  app.add_option("--set", overrides, "Override one key: section.key=value (repeatable)")
      ->take_all()
      ->allow_extra_args(false);
  app.add_flag("--dump-config", dump, "Print every key in force with its meaning, and stop");
}

void makeFolder(const std::string& path, std::initializer_list<const char*> files) {
  if (path.empty()) return;
  std::error_code status;
  std::filesystem::create_directories(path, status);
  if (status) throw base::Error(path + ": the folder cannot be made (" + status.message() + ")");
  base::requireWritableFolder(path);
  for (const char* file : files) base::requireWritable((std::filesystem::path(path) / file).string());
}

void requireNew(const std::string& path, bool overwrite) {
  if (!path.empty() && !overwrite && std::filesystem::is_regular_file(path))
    throw base::Error(path + ": exists already; choose another name or give --overwrite");
  base::requireWritable(path);
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
