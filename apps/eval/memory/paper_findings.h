// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/table.h"
#include "memory/lab_figures.h"

#include <string>
#include <vector>

namespace engram::apps {

/// Something that F says of its figures 9 to 17 (F-28, F-29), held against ours.
struct PaperFinding {
  std::string claim;
  bool found = false;
  std::string figures;  ///< that decide, in words
};

/// Those that the figures can tell: methods or conditions that were not run leave theirs out. What is found
/// is found in the mean values; intervals are in the table of the figures. Errors are of all images, in
/// places.
std::vector<PaperFinding> paperFindings(const std::vector<LabFigure>& figures);

ResultTable tableOf(const std::vector<PaperFinding>& findings);

}  // namespace engram::apps
