// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/frame_report.h"

#include <chrono>
#include <string>

namespace engram::pipeline {

/// Writes the wall time of a step into the report when it goes out of scope.
class StepTimer {
 public:
  StepTimer(types::FrameReport& report, std::string step)
      : report_(report), step_(std::move(step)), start_(std::chrono::steady_clock::now()) {}
  ~StepTimer() {
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start_;
    report_.times.push_back({std::move(step_), elapsed.count()});
    report_.milliseconds += elapsed.count();
  }
  StepTimer(const StepTimer&) = delete;
  StepTimer& operator=(const StepTimer&) = delete;

 private:
  types::FrameReport& report_;
  std::string step_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace engram::pipeline
