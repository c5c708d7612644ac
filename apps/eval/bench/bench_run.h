// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bench/bench_images.h"
#include "engram/pipeline/params.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace engram::apps {

/// What a map of one size costs. Times are processor time of all threads together [ms].
struct BenchFigures {
  std::size_t places = 0;
  std::string scorer;            ///< [recognise] scorer
  std::vector<double> localise;  ///< each image from pixels to an answer
  std::vector<double> map;       ///< each image that extends the map, without writing it to the file
  std::map<std::string, std::vector<double>> steps;  ///< wall time of the steps of localising each image
  std::vector<double> reference;  ///< fixed work, done after each image: how fast the machine was
  double open = 0;                ///< from the file to the first answer
  double recall = 0;              ///< share of single images whose most similar place is that of exact search
  int right = 0;            ///< answers that name the place shown, or a neighbour of it; of all of `localise`
  int firstRight = 0;       ///< the same of the most similar place to each single image,
  int exactRight = 0;       ///< and of exact search
  std::uint64_t rss = 0;    ///< memory that the opened map takes [bytes]
  std::uint64_t bytes = 0;  ///< of the file
};

struct BenchAsk {
  int drive = 40;       ///< images of one drive that are localised, and others that extend the map
  int singles = 40;     ///< single images for the recall
  bool wheels = false;  ///< images come with odometry
};

/// Throws base::Interrupted on Ctrl-C.
BenchFigures measureMap(const BenchImages& images, const pipeline::PipelineParams& params,
                        const BenchAsk& ask, std::size_t places, const std::string& file);

}  // namespace engram::apps
