// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/error.h"
#include "engram/keeper/edits.h"
#include "engram/map/topological_map.h"
#include "engram/pipeline/map_relaxer.h"
#include "engram/store/report_json.h"
#include "engram/upkeep/upkeep.h"

#include <algorithm>

namespace engram::keeper {
namespace {

constexpr double kGrowth = 1.25;     // of the neighbourhood, from pass to pass
constexpr double kWidest = 1000;     // [m]
constexpr double kRecordBytes = 64;  // of the database beside each text
constexpr double kPathBytes = 160;   // of a path point

/// Which places there are, from the oldest to the newest.
std::vector<map::PlaceId> byAge(const map::TopologicalMap& map) {
  std::vector<map::PlaceId> ids;
  for (const auto& [id, place] : map.places()) ids.push_back(id);
  std::stable_sort(ids.begin(), ids.end(), [&](map::PlaceId a, map::PlaceId b) {
    return map.place(a).createdStamp < map.place(b).createdStamp;
  });
  return ids;
}

std::uint64_t fixedBytes(const store::WholeMap& map) {
  double bytes = kPathBytes * static_cast<double>(map.content.path.size());
  for (const auto& record : map.records)
    bytes += kRecordBytes + static_cast<double>(store::toJson(record).size());
  return static_cast<std::uint64_t>(bytes);
}

/// A map on its way to a target.
class Reduction {
 public:
  Reduction(store::WholeMap& whole, const Target& target)
      : map_(std::move(whole.content)),
        target_(target),
        fixed_(fixedBytes(whole)),
        bytes_(store::rowBytes(map_.content())) {}

  bool reached() const {
    return (!target_.views || map_.places().size() <= *target_.views) &&
           (!target_.bytes || bytes() <= *target_.bytes);
  }
  std::uint64_t bytes() const {
    std::uint64_t sum = fixed_;
    for (const auto& [id, n] : bytes_) sum += n;
    return sum;
  }
  std::size_t removed() const { return removed_; }
  map::TopologicalMap& map() { return map_; }

  /// One place after the other counts as new to its neighbourhood.
  void pass(const upkeep::Budget& budget) {
    const auto inliers = upkeep::edgeInliers(map_);
    for (const map::PlaceId id : byAge(map_)) {
      if (reached()) return;
      if (map_.places().contains(id)) thin(upkeep::plan(map_, id, budget, inliers));
    }
  }

 private:
  /// Standings are of drives, and one view a step: the target may lie between.
  void thin(const std::vector<upkeep::Edit>& edits) {
    for (const upkeep::Edit& edit : edits) {
      const auto* removal = std::get_if<upkeep::RemoveView>(&edit);
      if (removal == nullptr || reached() || map_.neighbours(removal->place).empty()) continue;
      upkeep::apply(map_, {edit});
      bytes_.erase(removal->place);
      ++removed_;
    }
  }

  map::TopologicalMap map_;
  Target target_;
  std::uint64_t fixed_;
  std::map<map::PlaceId, std::uint64_t> bytes_;
  std::size_t removed_ = 0;
};

}  // namespace

Reduced reduce(store::WholeMap& whole, const Target& target, const pipeline::PipelineParams& params) {
  upkeep::Budget budget = params.upkeep.budget(params.stereo.min_inliers);
  budget.rule.probation = false;
  const std::size_t before = whole.content.places.size();
  Reduction reduction(whole, target);
  for (budget.rule.max_views = std::min<int>(budget.rule.max_views, static_cast<int>(before));
       !reduction.reached() && budget.rule.max_views > 1;)
    reduction.pass((--budget.rule.max_views, budget));
  // Headings stop to count once a neighbourhood is wider than the rule has it.
  while (!reduction.reached() && budget.near.distance < kWidest) {
    budget.near.distance *= kGrowth;
    budget.near.angle = M_PI;
    budget.near.search_distance = std::max(budget.near.search_distance, 2 * budget.near.distance);
    budget.near.search_sigma = kWidest;
    reduction.pass(budget);
  }
  whole.content = reduction.map().content();
  return {reduction.removed(), budget.near.distance, budget.rule.max_views, reduction.bytes(),
          reduction.reached()};
}

}  // namespace engram::keeper
