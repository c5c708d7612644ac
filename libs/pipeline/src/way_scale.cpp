// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "way_scale.h"

#include <algorithm>
#include <cmath>

namespace engram::pipeline {
namespace {

// Straight distances between fixes, so long that the error of these counts little and so short that the
// heading of the wheels has not drifted much: the distance does not depend on the heading at its beginning.
constexpr double kLeastChord = 5, kMostChord = 20;  // [m]
constexpr int kLeastChords = 20;
constexpr double kFixesAtAPlace = 2;
constexpr double kMostSigmas = 5;  // by which wheels differ from a map; more is another unit

}  // namespace

void WayScale::add(const Eigen::Vector3d& inMap, const Eigen::Vector3d& byWheels, int piece) {
  if (piece != piece_) fixes_.clear();
  piece_ = piece;
  const double step = fixes_.empty() ? 0 : (byWheels - fixes_.back().byWheels).norm();
  ++fixesOfAll_;
  fixes_.push_back({inMap, byWheels, (fixes_.empty() ? 0 : fixes_.back().way) + step});
  while (fixes_.back().way - fixes_.front().way > kMostChord) fixes_.pop_front();
  for (const Fix& from : fixes_) {
    const double wheels = (byWheels - from.byWheels).norm(), map = (inMap - from.inMap).norm();
    if (wheels < kLeastChord) continue;
    ++chords_;
    mapSquared_ += map * map;
    wheelsSquared_ += wheels * wheels;
    product_ += map * wheels;
  }
}

std::optional<WayScale::Ratio> WayScale::ratio() const {
  if (chords_ < kLeastChords || !(product_ > 0)) return std::nullopt;
  const double ratio = product_ / wheelsSquared_;
  const double residual = std::max(0.0, mapSquared_ - ratio * product_);
  // Fixes at one place share the errors of its memory.
  const double independent = std::max(1.0, fixesOfAll_ / kFixesAtAPlace);
  return Ratio{std::log(ratio), std::sqrt(residual / wheelsSquared_ / independent)};
}

Stretch stretchFor(const WayScale::Ratio& ratio, int drives, double sigma) {
  const double map = sigma * sigma / drives, own = sigma * sigma;
  const double variance = map + own + ratio.sigma * ratio.sigma;
  if (std::abs(ratio.log) > kMostSigmas * std::sqrt(variance)) return {};
  const double gain = ratio.log / variance;
  return {std::exp(-gain * map), std::exp(gain * own)};
}

}  // namespace engram::pipeline
