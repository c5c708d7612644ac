// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "slam_figures.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <iomanip>
#include <ostream>

namespace engram::apps {

void SlamFigures::add(const types::FrameReport& report, const map::TopologicalMap& map,
                      const MapTruth* truth) {
  milliseconds_.add(report.milliseconds);
  use_.add(report);
  recognised_ += report.outcome == types::Outcome::kRecognised;
  made_ += report.outcome == types::Outcome::kNewPlace;
  refused_ += report.outcome == types::Outcome::kRefused;
  unusable_ += report.outcome == types::Outcome::kUnusable;
  lateClosures_ += report.closuresRestored;
  hasTruth_ = truth != nullptr;
  if (!report.closure) return;
  // A map of views has closed the loop to an older view: the best guess.
  const base::PlaceId to = report.outcome == types::Outcome::kNewPlace ? report.bestGuess : report.place;
  const auto verdict = truth ? truth->judgeClosure(map, report, to) : evaluation::Verdict::kUnknown;
  closures_.push_back({report.index, report.label, to, map.place(to).createdLabel, verdict});
}

nlohmann::json SlamFigures::toJson(const map::TopologicalMap& map, std::uint64_t mapBytes,
                                   std::uint64_t peakRss) const {
  nlohmann::json closures = nlohmann::json::array();
  int falseClosures = 0;
  for (const auto& c : closures_) {
    falseClosures += c.verdict == evaluation::Verdict::kWrong;
    nlohmann::json right = nullptr;
    if (c.verdict != evaluation::Verdict::kUnknown) right = c.verdict == evaluation::Verdict::kRight;
    closures.push_back({{"index", c.index},
                        {"label", c.label},
                        {"place", c.place.value},
                        {"place_label", c.placeLabel},
                        {"right", right}});
  }
  const evaluation::Percentiles ms = milliseconds_.summary();
  const auto places = map.places().size();
  return {{"images", images()},
          {"keyframes", recognised_ + made_ + refused_},
          {"new_places", made_},
          {"recognised", recognised_},
          {"refused", refused_},
          {"unusable", unusable_},
          {"causes", use_.toJson()},
          {"places", places},
          {"views", map.views().size()},
          {"edges", map.edges().size()},
          {"closures", closures_.size()},
          {"false_closures", hasTruth_ ? nlohmann::json(falseClosures) : nlohmann::json(nullptr)},
          {"closure_list", closures},
          {"late_closures", lateClosures_},
          {"ate_m", error_ ? nlohmann::json(error_->ate) : nlohmann::json(nullptr)},
          {"ate_apart", error_ ? nlohmann::json(error_->apart) : nlohmann::json(nullptr)},
          {"map_bytes", mapBytes},
          {"bytes_per_place", mapBytes / std::max<std::size_t>(1, places)},
          {"ms_per_image", {{"mean", ms.mean}, {"median", ms.median}, {"p95", ms.p95}, {"max", ms.max}}},
          {"peak_rss_bytes", peakRss}};
}

void SlamFigures::print(std::ostream& out, const map::TopologicalMap& map, const std::string& path,
                        std::uint64_t mapBytes) const {
  const evaluation::Percentiles ms = milliseconds_.summary();
  const auto isFalse = [](const Closure& c) { return c.verdict == evaluation::Verdict::kWrong; };
  out << path << ": " << map.places().size() << " places, " << map.views().size() << " views, "
      << map.edges().size() << " edges, " << (mapBytes + 512) / 1024 << " KiB\n"
      << "  this drive: " << images() << " images, " << made_ << " new places, " << recognised_
      << " recognised, " << refused_ << " refused, " << unusable_ << " unusable, " << closures_.size()
      << " closures";
  if (hasTruth_) out << " (" << std::count_if(closures_.begin(), closures_.end(), isFalse) << " false)";
  if (lateClosures_ > 0) out << ", " << lateClosures_ << " found later";
  out << std::fixed << std::setprecision(1) << "\n  " << ms.mean << " ms per image (95 %: " << ms.p95
      << ", max: " << ms.max << ")";
  if (error_) out << std::setprecision(3) << ", trajectory error " << error_->ate << " m (rms)";
  if (error_ && error_->apart > 0)
    out << std::setprecision(1) << ", without the " << 100 * error_->apart
        << " % of the way in other parts of the map";
  out << "\n" << use_.summary();
}

}  // namespace engram::apps
