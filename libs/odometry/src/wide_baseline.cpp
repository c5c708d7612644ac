// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "wide_baseline.h"

#include "engram/features/matching.h"
#include "engram/odometry/visual_scan.h"

#include <cmath>

namespace engram::odometry {
namespace {

/// Where a motion that few points suggest lets look for more, to each side [px].
constexpr double kColumns = 20, kRows = 7;

}  // namespace

WideBaseline::WideBaseline(const types::StereoModel& model, cv::Mat mask)
    : model_(model), mask_(std::move(mask)), extractor_(features::makeExtractor({})) {}

void WideBaseline::describe(View& view) const {
  if (view.features) return;
  const types::Features all = extractor_->extract(view.pair().left, mask_);
  std::vector<int> kept;
  std::vector<float> ranges;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto& k = all.keypoints[i];
    const auto d = view.rows().disparity(k.x, k.y);
    if (!d) continue;
    kept.push_back(static_cast<int>(i));
    ranges.push_back(types::rangeOf({k.x, k.y, *d}, model_));
  }
  view.features = all.subset(kept);
  view.features->ranges = std::move(ranges);
}

std::vector<geometry::StereoMatch> WideBaseline::toStereo(const View& a, const View& b,
                                                          const std::vector<types::Match>& matches) const {
  const auto pointOf = [this](const types::Features& f, int i) {
    const auto k = static_cast<std::size_t>(i);
    return types::stereoPoint(f.keypoints[k], f.ranges[k], model_);
  };
  std::vector<geometry::StereoMatch> out;
  for (const auto& m : matches) out.push_back({pointOf(*a.features, m.a), pointOf(*b.features, m.b)});
  return out;
}

std::vector<geometry::StereoMatch> WideBaseline::match(View& a, View& b) const {
  describe(a);
  describe(b);
  return toStereo(a, b, features::match(*a.features, *b.features, {}));
}

std::vector<geometry::StereoMatch> WideBaseline::matchNear(View& a, View& b,
                                                           const Eigen::Isometry3d& T_a_b) const {
  describe(a);
  describe(b);
  const ScanMatchParams near{.window_width = std::atan(kColumns / model_.f),
                             .window_height = std::atan(kRows / model_.f)};
  return toStereo(a, b, matchScans(*a.features, *b.features, T_a_b, model_, near));
}

}  // namespace engram::odometry
