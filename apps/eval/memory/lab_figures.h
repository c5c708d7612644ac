// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/table.h"
#include "engram/evaluation/bootstrap.h"
#include "memory/memory_lab.h"

#include <string>
#include <vector>

namespace engram::apps {

/// Success: the answer is within so many places of the truth (F-26).
inline constexpr double kSuccessDistance = 1.25;

/// One line of the results.
struct LabFigure {
  std::string method;
  std::string condition;
  int update = 1;
  evaluation::Interval globalSuccess;  ///< share, by the interpolated peak (F-E14)
  evaluation::Interval localSuccess;
  evaluation::Interval globalWhole;  ///< share, by the most probable place: within one place of the true one
  evaluation::Interval localWhole;
  evaluation::Interval globalError;  ///< mean distance [places]
  evaluation::Interval localError;
  evaluation::Interval error;  ///< of all images of the sequences
  double bytesPerPlace = 0;
};

/// All cells of all runs, with 95 % intervals by bootstrap over stretches of the test drives.
std::vector<LabFigure> figuresOf(const std::vector<MethodRun>& runs, const std::vector<Sequence>& sequences,
                                 int sequenceLength);

/// How much more often a method succeeds than another on the same images, global and local together.
struct Advantage {
  std::string condition;
  std::string over;            ///< the other method
  evaluation::Interval share;  ///< positive: better
};

/// Of the first run over each other one, in every condition of the last update.
std::vector<Advantage> advantagesOfFirst(const std::vector<MethodRun>& runs,
                                         const std::vector<Sequence>& sequences, int sequenceLength);

ResultTable tableOf(const std::vector<LabFigure>& figures);
ResultTable tableOf(const std::vector<Advantage>& advantages);

/// The name of a condition as a page has it.
const std::string& inWords(const std::string& condition);

}  // namespace engram::apps
