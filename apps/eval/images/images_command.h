// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/contender.h"
#include "common/experiment.h"
#include "engram/evaluation/bootstrap.h"
#include "engram/evaluation/truth.h"

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace engram::apps {

/// What one method does with the images that it has not learnt from.
struct ImagesResult {
  std::string method;
  evaluation::Interval singleBefore, singleAfter;      ///< share right, each image by itself
  evaluation::Interval filteredBefore, filteredAfter;  ///< share right, with the belief carried on
  Learning learning;
  Holdings holdings;
};

/// engram-eval images: the memories on two traversals of one way. The first is the map, one place an image;
/// the even images of the second are learnt from, the odd ones are located, before and after that.
class ImagesCommand final : public Experiment {
 public:
  std::string name() const override { return "images"; }
  std::string description() const override;
  std::string examples() const override;

 private:
  void declareMore(CLI::App& command) override;
  void configure(base::Config& config) override { pipeline_.bind(config); }
  void check() override;
  std::string identity() const override;
  std::vector<std::string> results() const override { return {"results.csv"}; }
  Findings measure(const Workplace& place, const std::string& settings) override;

  std::vector<LearnView> readImages(const std::string& folder, pipeline::Perception& perception,
                                    std::ostream* progress) const;
  ImagesResult measureOne(const Method& method, const std::vector<LearnView>& reference,
                          const std::vector<LearnView>& query) const;
  evaluation::Interval locate(const Contender& contender, const Method& method,
                              const std::vector<LearnView>& reference, const std::vector<LearnView>& query,
                              bool filtered) const;
  /// Throws base::Error when the truth cannot be that of these images.
  void requireTruthOf(const std::vector<LearnView>& references, const std::vector<LearnView>& query) const;
  bool isRight(const LearnView& query, const LearnView& place) const;

  pipeline::PipelineParams pipeline_;
  std::string reference_, query_, truthFile_;
  int margin_ = 0;
  std::optional<evaluation::Truth> truth_;
};

}  // namespace engram::apps
