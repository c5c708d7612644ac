// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/map_truth.h"
#include "engram/apps/run_use.h"
#include "engram/base/line_file.h"
#include "engram/evaluation/running_percentiles.h"
#include "engram/evaluation/score.h"
#include "engram/map/topological_map.h"
#include "engram/types/frame_report.h"

#include <nlohmann/json_fwd.hpp>

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace engram::apps {

/// The answers of a localisation run, held against the truth where there is one. Without truth its memory
/// does not grow: a live run may last for weeks.
class LocalizeFigures {
 public:
  /// @param csv takes a line an image: index, stamp, label, outcome, place and best guess with the images
  /// that
  ///   made them, posterior, similarity, inliers, verdicts, error [places], time [ms],
  ///   reason, pose in the map [m, rad] with deviations, its error where there is truth, what it was
  ///   accepted by
  LocalizeFigures(const map::TopologicalMap& map, const MapTruth* truth, base::LineFile& csv)
      : map_(map), truth_(truth), csv_(csv) {}

  void add(const types::FrameReport& report);
  /// Places that learnt after the last image.
  void addLearnt(std::size_t places) { learnt_ += places; }
  int images() const { return milliseconds_.count(); }
  const RunUse& use() const { return use_; }

  /// Keys: images, queries, answerable, accepted, right, wrong, best_guess_right, within_1_25_places,
  /// error_places {mean, median, p95, max}, pose_error [m] and heading_error [rad] likewise, pose_nees (1
  /// when the reported covariance is right), accepted_by_sequence (of those accepted), adapted, causes
  /// {reason: count}, ms_per_image {mean, median, p95, max}, peak_rss_bytes. Verdicts are null without truth.
  nlohmann::json toJson() const;
  void print(std::ostream& out) const;

 private:
  struct PoseScore {
    evaluation::Percentiles position;  // [m]
    evaluation::Percentiles heading;   // [rad]
    double nees = 0;
  };
  PoseScore poseScore() const;
  void write(const types::FrameReport& report, const evaluation::LocalisationResult& result,
             const std::optional<PoseError>& off);
  std::string label(base::PlaceId place) const;
  int withinF26() const;

  const map::TopologicalMap& map_;
  const MapTruth* truth_;
  base::LineFile& csv_;
  std::vector<evaluation::LocalisationResult> results_;  // none without truth
  std::vector<PoseError> poseErrors_;                    // the same
  evaluation::RunningPercentiles milliseconds_;
  RunUse use_;
  int accepted_ = 0, bySequence_ = 0;
  std::size_t learnt_ = 0;
};

}  // namespace engram::apps
