// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval_program.h"

int main(int argc, char** argv) {
  engram::apps::EvalProgram program;
  return engram::apps::runProgram(program, argc, argv);
}
