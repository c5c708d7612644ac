// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bench/bench_run.h"
#include "common/experiment.h"

#include <string>
#include <vector>

namespace engram::apps {

/// Section `[bench]`.
struct BenchParams {
  int images = 120;     ///< rendered, or read of --images, that the places are made of; 0: all that there are
  int drive = 40;       ///< images of a drive that is localised, and of one that extends the map
  int singles = 40;     ///< images for the recall
  bool wheels = false;  ///< images come with odometry

  void describe(base::Params& p);
};

/// engram-eval bench: time, memory and recall of localising in maps of up to tens of thousands of places.
class BenchCommand final : public Experiment {
 public:
  std::string name() const override { return "bench"; }
  std::string description() const override;
  std::string examples() const override;

 private:
  void declareMore(CLI::App& command) override;
  void configure(base::Config& config) override;
  void check() override;
  std::string identity() const override;
  std::vector<std::string> results() const override { return {"bench.csv"}; }
  Findings measure(const Workplace& place, const std::string& settings) override;

  std::string mapSettings();
  void prepareMaps(const Workplace& place);
  std::vector<cv::Mat> sourceImages(const Workplace& place) const;
  std::vector<cv::Mat> rendered(const Workplace& place) const;
  std::vector<cv::Mat> read() const;
  void compare(Findings& findings) const;

  BenchParams bench_;
  pipeline::PipelineParams pipeline_;
  std::vector<int> places_;  ///< --places
  std::string images_;       ///< --images
  std::string compare_;      ///< --compare,
  nlohmann::json before_;    ///< and what it holds
};

}  // namespace engram::apps
