// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/contender.h"
#include "common/recorded_drive.h"
#include "common/workplace.h"
#include "engram/base/params.h"

#include <cstdint>
#include <string>
#include <vector>

namespace engram::apps {

/// Section `[memory_lab]`: the protocol of F-22 to F-30.
struct MemoryLabParams {
  std::string preset = "office";  ///< building of the simulator
  int places = 80;                ///< evenly spaced along the tour; one image each in update 1 (F-08, F-22)
  int updates = 8;                ///< drives that are learnt from; the first builds the map (F-E20)
  int test_days = 4;              ///< test drives on the days after the last update
  double test_spacing = 1.0;      ///< between test images [m]
  int sequences = 100;            ///< random sequences for each figure (F-25)
  int sequence_length = 10;       ///< images in each; the paper does not say (F-E18)
  double noise = 0.15;            ///< sigma of the image noise, intensities in [0, 1] (F-E15)
  int bow_words = 1000;           ///< dictionary of the larger bag of words; the paper has 80 (F-27)

  void describe(base::Params& p);
};

/// What is done to a test image before it is localised (F-25).
struct Condition {
  std::string name;
  bool noisy = false;
  double removed = 0.0;  ///< share of the features removed at random
};
const std::vector<Condition>& conditions();

/// A random run of test images: the first is located with no prior knowledge, the others are tracked (F-25).
struct Sequence {
  int drive = 0;
  int first = 0;
  int block = 0;  ///< stretch of the drive it starts in: what the bootstrap resamples
};

/// Localisation error of every image of every sequence, sequence by sequence [places].
struct Cell {
  std::string condition;
  int update = 1;
  std::vector<float> interpolated;  ///< sub-place peak against the true position (F-E14)
  std::vector<float> whole;         ///< most probable place against the place nearest to the truth
};

struct UpdateState {
  Holdings holdings;
  Learning learning;
};

/// Everything measured of one method.
struct MethodRun {
  std::string method;
  std::vector<UpdateState> updates;
  std::vector<Cell> cells;
};

/// The drives of the protocol, recorded once.
struct LabDrives {
  std::vector<RecordedDrive> tours;
  std::vector<RecordedDrive> tests;
};

class MemoryLab {
 public:
  MemoryLab(const MemoryLabParams& params, const pipeline::PipelineParams& pipeline, Workplace place);

  /// Renders what is not yet in the folder. Throws base::Interrupted.
  void record();
  /// Runs every method in these conditions; runs found in the folder are read. Throws base::Interrupted.
  /// @param kind part of the file names, so that sweeps and main runs stand apart
  std::vector<MethodRun> run(const std::vector<Method>& methods, const std::vector<Condition>& conditions,
                             const std::string& kind);

  const LabDrives& drives() const { return drives_; }
  const std::vector<Sequence>& sequences() const { return sequences_; }
  const MemoryLabParams& params() const { return params_; }

 private:
  MethodRun runOne(const Method& method, const std::vector<Condition>& conditions) const;
  Cell test(const Contender& contender, const Method& method, const Condition& condition, int update) const;
  std::vector<LearnView> learnViews(const RecordedDrive& drive) const;
  double trueStation(const Sample& sample) const;

  MemoryLabParams params_;
  pipeline::PipelineParams pipeline_;
  Workplace place_;
  LabDrives drives_;
  std::vector<Sequence> sequences_;
};

/// Distance on a closed tour of `places` places.
double ringDistance(double a, double b, double places);

}  // namespace engram::apps
