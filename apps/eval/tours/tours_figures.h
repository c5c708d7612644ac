// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/table.h"
#include "engram/evaluation/bootstrap.h"
#include "tours/tours_lab.h"

#include <string>
#include <vector>

namespace engram::apps {

/// The figures of one method over all tours but the first. Intervals: 95 %, tours drawn as blocks (D-E5).
struct ToursFigure {
  std::string method;
  int queries = 0;
  /// Share of the images whose winner is neither the last place that the robot passed nor the next one. The
  /// paper does not define a failure (D-E5). Half-way between two places either is a right answer, and both
  /// lie within one pitch of the places; a place beyond them is not where the robot is.
  evaluation::Interval failure;
  evaluation::Interval strict;         ///< share whose winner is not the nearest place
  evaluation::Interval few;            ///< share with few matched points (D-11)
  evaluation::Interval fewVerified;    ///< the same for points that geometry confirms
  MeanSigma matched, verified;         ///< points with the winner (D-09), over the images
  double learnt = 0, learntWrong = 0;  ///< share of the images learnt from; share of those at a failure
  evaluation::Interval failureOver, fewOver;  ///< less those of the baseline, image by image
  std::vector<int> histogram;                 ///< number of images with 0, 1, 2 … matched points
};

/// @param baseline name of the run that the others are compared with; without it `failureOver` is unknown
std::vector<ToursFigure> figuresOf(const std::vector<ToursRun>& runs, int fewMatches,
                                   const std::string& baseline = "static");

/// One line a method.
ResultTable tableOf(const std::vector<ToursFigure>& figures, int fewMatches);
/// One line a method and tour.
std::string toCsv(const std::vector<ToursRun>& runs, int fewMatches);
/// The table of the methods beside the paper's figures.
std::string toText(const std::vector<ToursFigure>& figures, const std::vector<ToursRun>& runs,
                   int fewMatches);

}  // namespace engram::apps
