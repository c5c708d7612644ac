// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/table.h"
#include "engram/evaluation/precision_recall.h"
#include "engram/evaluation/score.h"
#include "words/loop_benchmark.h"

#include <map>
#include <string>
#include <vector>

namespace engram::apps {

/// What became of a sequence of images, for peers to compare with.
struct LoopFigures {
  int images = 0;
  int positives = 0;                        ///< images that have a right answer
  int accepted = 0;                         ///< the next two, and those that the truth says nothing about
  int trueClosures = 0, falseClosures = 0;  ///< accepted answers
  int bestGuessRight = 0;                   ///< positives whose most probable place is right
  evaluation::PrecisionRecall curve;        ///< over all best answers, accepted or not
  std::map<int, double> recallAt;           ///< positives with a right answer among the first K
  evaluation::Percentiles milliseconds;     ///< of one image
};
LoopFigures figuresOf(const std::vector<LoopAnswer>& answers);

nlohmann::json toJson(const LoopFigures& figures);
/// The answer to every image; the points of the curve; the figures in words.
ResultTable tableOf(const std::vector<LoopAnswer>& answers);
ResultTable tableOf(const evaluation::PrecisionRecall& curve);
std::string toText(const LoopFigures& figures);
/// @param settings the configuration, as text
std::string toHtml(const LoopFigures& figures, const std::vector<LoopAnswer>& answers,
                   const std::string& settings);

}  // namespace engram::apps
