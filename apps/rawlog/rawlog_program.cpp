// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "rawlog_program.h"

#include "engram/base/error.h"
#include "engram/base/text.h"

#include <charconv>
#include <ostream>

namespace engram::apps {

void CommonOptions::declare(CLI::App& app) {
  app.add_flag("-q,--quiet", quiet, "No progress on the terminal");
  app.add_option("--json", json, "Write the figures to this file, or to standard output (-)")
      ->type_name("FILE");
}

int finish(const std::string& problem, bool whole, bool interrupted, std::ostream& err) {
  if (!problem.empty()) err << "engram-rawlog: " << base::forTerminal(problem) << "\n";
  if (interrupted) err << "engram-rawlog: interrupted; what was done so far is kept\n";
  return whole && !interrupted ? kOk : kPartial;
}

std::pair<int, int> parseSize(const std::string& text, const std::string& option) {
  int width = 0, height = 0;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, width);
  const bool hasX = first.ec == std::errc() && first.ptr != end && *first.ptr == 'x';
  const auto second = hasX ? std::from_chars(first.ptr + 1, end, height) : first;
  if (!hasX || second.ec != std::errc() || second.ptr != end || width <= 0 || height <= 0)
    throw UsageError(option + " '" + text + "': expected two whole numbers such as 640x480");
  return {width, height};
}

RawlogProgram::RawlogProgram() {
  add(makePackCommand());
  add(makeImportCommand());
  add(makeInfoCommand());
  add(makeUnpackCommand());
  add(makeCalibrateCommand());
}

std::string RawlogProgram::description() const {
  return "Makes MRPT rawlogs of image folders and back, or of ROS bags, says what is in one, and calibrates "
         "cameras.";
}

}  // namespace engram::apps
