// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "motion_models.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

namespace engram::belief {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// A place this many standard deviations beside the way is as likely as that there is none.
constexpr double kOffTheMap = 2.0;
/// Mass moves once the robot has, by so many spacings: shorter steps would blur the belief at every image.
constexpr double kStride = 0.75;
constexpr double kReach = 3.0;      // standard deviations
constexpr double kDrift = 0.02;     // share of a layer that goes to each of its neighbours with an image
constexpr double kNothing = 1e-12;  // mass below which it is only spread in a small map

/// Places on the floor by square cells: a table of the cells, by open addressing, and the places cell by
/// cell.
class FloorGrid {
 public:
  FloorGrid(const std::vector<Eigen::Vector3d>& poses, double cell) : poses_(poses), cell_(cell) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted;
    for (std::size_t i = 0; i < poses.size(); ++i)
      sorted.emplace_back(key(index(poses[i].x()), index(poses[i].y())), static_cast<std::uint32_t>(i));
    std::sort(sorted.begin(), sorted.end());
    table_.resize(std::bit_ceil(2 * poses.size() + 1));
    for (const auto& [cellKey, place] : sorted) {
      Cell& mine = at(cellKey);
      if (mine.end == 0) mine = {cellKey, static_cast<std::uint32_t>(places_.size()), 0};
      places_.push_back(place);
      mine.end = static_cast<std::uint32_t>(places_.size());
    }
  }

  /// Calls f(place, squared distance) for all places in the nine cells around a point.
  template <class F>
  void around(const Eigen::Vector2d& p, F&& f) const {
    const std::int32_t column = index(p.x()), row = index(p.y());
    for (std::int32_t x = column - 1; x <= column + 1; ++x)
      for (std::int32_t y = row - 1; y <= row + 1; ++y) {
        const Cell& cell = at(key(x, y));
        for (std::uint32_t k = cell.begin; k < cell.end; ++k)
          f(places_[k], (poses_[places_[k]].head<2>() - p).squaredNorm());
      }
  }

 private:
  struct Cell {
    std::uint64_t key = 0;
    std::uint32_t begin = 0, end = 0;  // in `places_`; end 0: free
  };

  std::int32_t index(double x) const { return static_cast<std::int32_t>(std::floor(x / cell_)); }
  static std::uint64_t key(std::int32_t x, std::int32_t y) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32 | static_cast<std::uint32_t>(y);
  }
  /// The cell, or the free one where it would be.
  const Cell& at(std::uint64_t key) const {
    std::size_t i = static_cast<std::size_t>(key * 0x9e3779b97f4a7c15ULL >> 32);
    for (i &= table_.size() - 1; table_[i].end != 0 && table_[i].key != key;)
      i = (i + 1) & (table_.size() - 1);
    return table_[i];
  }
  Cell& at(std::uint64_t key) { return const_cast<Cell&>(std::as_const(*this).at(key)); }

  const std::vector<Eigen::Vector3d>& poses_;
  double cell_;
  std::vector<Cell> table_;
  std::vector<std::size_t> places_;
};

struct Reached {
  std::size_t place;
  double weight;
};

/// Slow drift of odometry, and of the map: a little of each layer goes to its two neighbours.
Layers drifted(const Layers& from) {
  Layers out = from;
  const std::size_t n = from.size();
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < from[k].size(); ++i)
      out[k][i] += kDrift * (from[(k + 1) % n][i] + from[(k + n - 1) % n][i] - 2 * from[k][i]);
  return out;
}

}  // namespace

double OdometryMotion::rotation(std::size_t layer) const {
  return 2 * kPi * static_cast<double>(layer) / params_.advance_headings;
}

void OdometryMotion::reset() {
  headings_.clear();
  pending_.setZero();
}

void OdometryMotion::move(const Adjacency& adjacency, const Layers& from, const MotionHint& hint,
                          Layers& to) {
  headings_.clear();
  if (!hint.odometry || adjacency.poses.empty()) {
    pending_.setZero();
    return blind_.move(adjacency, from, hint, to);
  }
  heading_ = hint.odometry->heading;
  for (const auto& pose : adjacency.poses) headings_.push_back(pose.z());

  pending_ += hint.odometry->step;
  if (pending_.norm() < kStride * hint.odometry->spacing) {
    for (std::size_t k = 0; k < to.size(); ++k)
      for (std::size_t i = 0; i < adjacency.size(); ++i) to[k][i] += from[k][i];
    return;
  }
  const double sigma = params_.sigma_odometry * hint.odometry->spacing;
  const FloorGrid grid(adjacency.poses, kReach * sigma);
  const double nowhere = gaussian(kOffTheMap, 1.0);
  const std::size_t n = adjacency.size();
  const double least = nothing(n, from.size(), kNothing);
  const Layers turned = drifted(from);
  Layers blind(from.size(), std::vector<double>(n, 0.0));
  double lost = 0.0;
  std::vector<Reached> reached;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const Eigen::Vector2d step = Eigen::Rotation2Dd(rotation(k)) * pending_;
    for (std::size_t i = 0; i < n; ++i) {
      const double mass = turned[k][i];
      if (mass < least) {
        lost += mass;
        continue;
      }
      reached.clear();
      double total = nowhere;
      grid.around(adjacency.poses[i].head<2>() + step, [&](std::size_t j, double squared) {
        if (squared > kReach * kReach * sigma * sigma) return;
        reached.push_back({j, std::exp(-0.5 * squared / (sigma * sigma))});
        total += reached.back().weight;
      });
      blind[k][i] = params_.advance_blind * mass;
      const double steered = mass - blind[k][i];
      for (const Reached& r : reached) to[k][r.place] += steered * r.weight / total;
      lost += steered * nowhere / total;
    }
  }
  blind_.move(adjacency, blind, hint, to);
  pending_.setZero();
  const double each = lost / static_cast<double>(n * to.size());
  for (auto& layer : to)
    for (double& p : layer) p += each;
}

double OdometryMotion::visible(std::size_t layer, std::size_t place) const {
  if (params_.view_sigma <= 0 || place >= headings_.size()) return 1.0;
  const double apart = std::remainder(heading_ + rotation(layer) - headings_[place], 2 * kPi);
  // The score of a place says nothing of headings: over all of them, the evidence is what the score says.
  const double sigma = params_.view_sigma;
  const double mean = sigma / std::sqrt(2 * kPi) * std::erf(kPi / (sigma * std::sqrt(2.0)));
  return gaussian(apart, sigma) / mean;
}

}  // namespace engram::belief
