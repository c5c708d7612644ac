// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/map_truth.h"
#include "engram/apps/run_use.h"
#include "engram/evaluation/running_percentiles.h"
#include "engram/map/topological_map.h"
#include "engram/types/frame_report.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace engram::apps {

/// The final figures of a mapping run.
class SlamFigures {
 public:
  /// To be called after each image, with the map as it is then.
  void add(const types::FrameReport& report, const map::TopologicalMap& map, const MapTruth* truth);
  void setTrajectoryError(std::optional<PathError> error) { error_ = error; }

  int images() const { return milliseconds_.count(); }
  const RunUse& use() const { return use_; }

  /// Keys: images, keyframes, unusable, refused, causes {reason: count}, places, views, edges, closures,
  /// false_closures (null without truth), closure_list [{index, label, place, place_label, right}], ate_m,
  /// ate_apart (null without TUM truth), map_bytes, bytes_per_place, ms_per_image {mean, median, p95, max},
  /// peak_rss_bytes.
  nlohmann::json toJson(const map::TopologicalMap& map, std::uint64_t mapBytes, std::uint64_t peakRss) const;
  void print(std::ostream& out, const map::TopologicalMap& map, const std::string& path,
             std::uint64_t mapBytes) const;

 private:
  struct Closure {
    std::uint64_t index = 0;
    std::string label;
    base::PlaceId place;
    std::string placeLabel;
    evaluation::Verdict verdict = evaluation::Verdict::kUnknown;
  };

  evaluation::RunningPercentiles milliseconds_;
  RunUse use_;
  std::vector<Closure> closures_;
  int recognised_ = 0, made_ = 0, refused_ = 0, unusable_ = 0, lateClosures_ = 0;
  bool hasTruth_ = false;
  std::optional<PathError> error_;
};

}  // namespace engram::apps
