// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/evaluation/truth.h"
#include "engram/map/topological_map.h"
#include "engram/pipeline/params.h"
#include "engram/types/frame.h"
#include "engram/types/frame_report.h"

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace engram::apps {

/// How a folder of images is played: as it is, or by a robot that stops and turns back.
struct PlayOptions {
  int stops = 0;    ///< images for which the robot stands still at each of three points, evenly spread
  int reverse = 0;  ///< images that it goes back half-way, and then forward again
};

/// Indices of the images in the order in which they are shown.
std::vector<std::size_t> playingOrder(std::size_t images, const PlayOptions& options);

/// The answer to one image. The place is the one accepted, or else the best hypothesis; near ones in the
/// sequence do not count (see LoopBenchmark::gap).
struct LoopAnswer {
  evaluation::FrameRef query;
  bool positive = false;  ///< an image shown before, or the map, holds a right answer
  types::Outcome outcome = types::Outcome::kSkipped;
  bool accepted = false;
  std::optional<evaluation::FrameRef> place;  ///< the image that made it
  evaluation::Verdict verdict = evaluation::Verdict::kUnknown;
  evaluation::Verdict bestGuess = evaluation::Verdict::kUnknown;  ///< of the maximum of the posterior
  double score = 0.0;  ///< verified matches plus posterior: a verified answer is surer than any other
  int rank = -1;       ///< of the first right hypothesis by posterior, from 0; -1: none of those reported
  double milliseconds = 0.0;  ///< the whole of Pipeline::process()
};

/// The loop-closure benchmark on images with ground truth.
struct LoopBenchmark {
  pipeline::PipelineParams pipeline;
  std::string images, reference;  ///< folders; with a reference its map is frozen and the images are located
  PlayOptions play;
  /// While mapping, an answer this near to the image in the sequence is no loop; it is neither right nor
  /// wrong.
  int gap = 10;
  std::ostream* progress = nullptr;

  /// One answer for each image that is shown. Throws base::Error for folders and images that cannot be used.
  std::vector<LoopAnswer> run(const evaluation::Truth& truth) const;
};

}  // namespace engram::apps
