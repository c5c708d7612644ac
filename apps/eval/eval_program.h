// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/program.h"

namespace engram::apps {

/// engram-eval: the papers' experiments, on the simulator and on real images.
class EvalProgram final : public CommandProgram {
 public:
  EvalProgram();
  std::string name() const override { return "engram-eval"; }
  std::string description() const override;
};

}  // namespace engram::apps
