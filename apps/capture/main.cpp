// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "capture_program.h"

int main(int argc, char** argv) {
  engram::apps::CaptureProgram program;
  return engram::apps::runProgram(program, argc, argv);
}
