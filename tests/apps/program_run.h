// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/program.h"

#include <sstream>
#include <string>
#include <vector>

namespace engram::apps {

/// What a program answered.
struct RunResult {
  int code = -1;
  std::string out, err;
};

/// Runs a program in this process, as its main() would.
template <class ProgramType>
RunResult runAs(const std::vector<std::string>& arguments) {
  ProgramType program;
  std::ostringstream out, err;
  const int code = runProgram(program, arguments, out, err);
  return {code, out.str(), err.str()};
}

}  // namespace engram::apps
