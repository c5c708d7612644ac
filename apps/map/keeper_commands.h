// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "edit_command.h"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace engram::apps {

/// engram-map reduce, relax, crop, anonymise, drives and closures: the tools of a keeper of maps.
class KeeperCommands {
 public:
  /// Adds the commands to the program.
  void declare(CLI::App& app);
  /// The exit code of the command that was given; none when it was none of these.
  std::optional<int> run(std::ostream& out, std::ostream& err);

 private:
  CLI::App* addEdit(CLI::App& parent, const std::string& name, const std::string& description);
  void declareDrives(CLI::App& app);
  void declareClosures(CLI::App& app);

  int reduce(std::ostream& out, std::ostream& err);
  int relax(std::ostream& out, std::ostream& err);
  int crop(std::ostream& out, std::ostream& err);
  int anonymise(std::ostream& out, std::ostream& err);
  int listDrives(std::ostream& out) const;
  int dropDrive(std::ostream& out, std::ostream& err);
  int listClosures(std::ostream& out) const;
  int rejectClosures(std::ostream& out, std::ostream& err);
  int addClosure(std::ostream& out, std::ostream& err);

  EditCommand edit_;
  CLI::App *reduce_ = nullptr, *relax_ = nullptr, *crop_ = nullptr, *anonymise_ = nullptr,
           *listDrives_ = nullptr, *dropDrive_ = nullptr, *listClosures_ = nullptr,
           *rejectClosures_ = nullptr, *addClosure_ = nullptr;
  std::string listed_, region_;
  std::uint64_t bytes_ = 0, views_ = 0;
  std::uint32_t drive_ = 0, placeA_ = 0, placeB_ = 0;
  std::vector<std::uint32_t> edges_;
  bool keepNames_ = false;
};

}  // namespace engram::apps
