// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/odometry/visual_scan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

namespace engram::odometry {
namespace {

/// L2 of unit vectors, or share of differing bits.
float distanceOf(const types::Descriptors& a, std::size_t i, const types::Descriptors& b, std::size_t j) {
  const auto dim = static_cast<std::size_t>(a.dim());
  float sum = 0;
  switch (a.kind()) {
    case types::DescriptorKind::kFloat: {
      const float *p = a.floats(i), *q = b.floats(j);
      for (std::size_t k = 0; k < dim; ++k) sum += (p[k] - q[k]) * (p[k] - q[k]);
      return std::sqrt(sum);
    }
    case types::DescriptorKind::kInt8: {
      const std::int8_t *p = a.int8(i), *q = b.int8(j);
      int squares = 0;
      for (std::size_t k = 0; k < dim; ++k) squares += (p[k] - q[k]) * (p[k] - q[k]);
      return std::sqrt(static_cast<float>(squares)) / types::kInt8Scale;
    }
    case types::DescriptorKind::kBinary: {
      const std::uint64_t *p = a.words(i), *q = b.words(j);
      int bits = 0;
      for (std::size_t k = 0; k < a.rowBytes() / 8; ++k) bits += std::popcount(p[k] ^ q[k]);
      return static_cast<float>(bits) / static_cast<float>(dim);
    }
  }
  return sum;
}

bool sameSign(const types::Keypoint& a, const types::Keypoint& b) {
  return a.sign == 0 || b.sign == 0 || a.sign == b.sign;
}

/// Features of one image by their row.
class RowIndex {
 public:
  explicit RowIndex(const types::Features& features) {
    for (std::size_t i = 0; i < features.size(); ++i)
      rows_.push_back({features.keypoints[i].y, static_cast<int>(i)});
    std::sort(rows_.begin(), rows_.end());
  }
  std::span<const std::pair<float, int>> between(double low, double high) const {
    const auto from = std::lower_bound(rows_.begin(), rows_.end(), std::pair(static_cast<float>(low), -1));
    auto to = from;
    while (to != rows_.end() && to->first <= high) ++to;
    return {from, to};
  }

 private:
  std::vector<std::pair<float, int>> rows_;
};

/// [px], columns and rows.
struct SearchWindow {
  double left, right, top, bottom;
};

/// For each of a the nearest of b within its window and the test, and only pairs that choose each other.
/// Windows are of a; a pair that is inside counts for both directions.
std::vector<types::Match> mutualBest(const types::Features& a, const types::Features& b,
                                     const std::function<std::optional<SearchWindow>(std::size_t)>& windowOf,
                                     const std::function<bool(std::size_t, std::size_t)>& test,
                                     double maxDistance) {
  if (!a.empty() && !b.empty() && !a.descriptors.sameLayout(b.descriptors))
    throw std::invalid_argument("visual scans: descriptors of different kinds");
  const RowIndex index(b);
  constexpr float kFar = std::numeric_limits<float>::max();
  std::vector<types::Match> best(a.size(), {-1, -1, kFar}), back(b.size(), {-1, -1, kFar});
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto window = windowOf(i);
    if (!window) continue;
    for (const auto& [row, j] : index.between(window->top, window->bottom)) {
      const auto k = static_cast<std::size_t>(j);
      const double u = b.keypoints[k].x;
      if (u < window->left || u > window->right || !sameSign(a.keypoints[i], b.keypoints[k]) || !test(i, k))
        continue;
      const types::Match match{static_cast<int>(i), j, distanceOf(a.descriptors, i, b.descriptors, k)};
      if (match.distance < best[i].distance) best[i] = match;
      if (match.distance < back[k].distance) back[k] = match;
    }
  }
  std::vector<types::Match> matches;
  for (const auto& m : best)
    if (m.b >= 0 && m.distance <= maxDistance && back[static_cast<std::size_t>(m.b)].a == m.a)
      matches.push_back(m);
  return matches;
}

double turnBetween(float a, float b) {
  return std::abs(std::remainder(static_cast<double>(a) - b, 2 * std::numbers::pi));
}

/// Between the rays that are so far [rad] to either side of the one through u.
std::pair<double, double> aroundRay(double u, double centre, double f, double reach) {
  constexpr double kWidest = 1.55;  // [rad]: a pinhole sees no farther
  const double ray = std::atan((u - centre) / f);
  return {centre + f * std::tan(std::max(-kWidest, ray - reach)),
          centre + f * std::tan(std::min(kWidest, ray + reach))};
}

}  // namespace

void ScanParams::describe(base::Params& p) {
  p.addDegrees("max_turn_deg", max_turn, "left and right: difference of orientation [deg]", {0, 180});
  p.add("max_rows", max_rows, "left and right: difference of the rows [px]", {0, 100});
  p.add("max_stereo_distance", max_stereo_distance,
        "left and right: distance of descriptors of length 1, or share of differing bits", {0, 2});
  p.add("min_depth", min_depth, "nearest points of a scan [m]", {0.01, 1000});
  p.add("max_depth", max_depth, "farthest points of a scan [m]", {0.1, 1e6});
}

void ScanMatchParams::describe(base::Params& p) {
  p.addDegrees("window_width_deg", window_width,
               "scan to scan: directions to each side of the expected one where a point is sought [deg]",
               {0.1, 90});
  p.addDegrees("window_height_deg", window_height, "scan to scan: the same up and down [deg]", {0.1, 90});
  p.add("max_distance", max_distance,
        "scan to scan: distance of descriptors of length 1, or share of differing bits", {0, 2});
}

types::Features makeScan(const types::Features& left, const types::Features& right,
                         const types::StereoModel& model, const ScanParams& params) {
  const double fb = model.f * model.baseline;
  const auto matches = mutualBest(
      left, right,
      [&](std::size_t i) {
        const auto& k = left.keypoints[i];
        return std::optional(SearchWindow{k.x - fb / params.min_depth, k.x - fb / params.max_depth,
                                          k.y - params.max_rows, k.y + params.max_rows});
      },
      [&](std::size_t i, std::size_t j) {
        return turnBetween(left.keypoints[i].angle, right.keypoints[j].angle) < params.max_turn;
      },
      params.max_stereo_distance);
  types::Features scan;
  std::vector<float> ranges;
  for (const auto& m : matches) {
    const auto& l = left.keypoints[static_cast<std::size_t>(m.a)];
    const auto& r = right.keypoints[static_cast<std::size_t>(m.b)];
    scan.append(left, static_cast<std::size_t>(m.a));
    ranges.push_back(types::rangeOf({l.x, l.y, static_cast<double>(l.x) - r.x}, model));
  }
  scan.ranges = std::move(ranges);
  return scan;
}

std::vector<types::Match> matchScans(const types::Features& a, const types::Features& b,
                                     const Eigen::Isometry3d& T_a_b, const types::StereoModel& model,
                                     const ScanMatchParams& params) {
  const Eigen::Isometry3d T_b_a = T_a_b.inverse();
  const auto windowOf = [&](std::size_t i) -> std::optional<SearchWindow> {
    if (i >= a.ranges.size() || !(a.ranges[i] > 0)) return std::nullopt;
    const Eigen::Vector3d point =
        T_b_a * model.toPoint(types::stereoPoint(a.keypoints[i], a.ranges[i], model));
    if (point.z() < 0.05) return std::nullopt;
    const auto at = model.project(point);
    const auto [left, right] = aroundRay(at.u, model.cx, model.f, params.window_width);
    const auto [top, bottom] = aroundRay(at.v, model.cy, model.f, params.window_height);
    return SearchWindow{left, right, top, bottom};
  };
  return mutualBest(
      a, b, windowOf, [](std::size_t, std::size_t) { return true; }, params.max_distance);
}

}  // namespace engram::odometry
