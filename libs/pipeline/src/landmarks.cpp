// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/landmarks.h"

#include <algorithm>
#include <cmath>

namespace engram::pipeline {
namespace {

using Eigen::Vector3d;

constexpr double kBesideParallax = 0.02;  // [rad]: such a distance does for what is seen beside a point
constexpr std::size_t kBeside = 5;        // points whose median distance stands for what is seen among them

constexpr std::size_t kFewestPoints = 8;  // that a length is believed of
constexpr double kRaySigma = 0.01;        // [rad]
constexpr double kRangeSigma = 0.15;      // of a range, as a share of it
constexpr double kLengthShare = 0.1;      // no length is known better than this share of it,
constexpr double kLengthFloor = 0.03;     // [m] and this
constexpr double kMostSpread = 0.5;       // of the points' lengths about their median, as a share of it

Vector3d rayOf(const types::Features& features, int i) {
  return features.bearings[static_cast<std::size_t>(i)].cast<double>();
}

/// A value of a sample with its weight.
struct Weighed {
  double value = 0, weight = 0;
};

double weightedMedian(std::vector<Weighed> sample) {
  std::sort(sample.begin(), sample.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  double half = 0;
  for (const Weighed& w : sample) half += 0.5 * w.weight;
  for (const Weighed& w : sample)
    if ((half -= w.weight) <= 0) return w.value;
  return sample.back().value;
}

/// Each point whose range is known gives a length of its own: where on the way its ray meets it.
std::vector<Weighed> lengths(const types::Features& view, const types::Features& place,
                             std::span<const types::Match> matches, const Eigen::Matrix3d& R_place_view,
                             const Vector3d& direction) {
  std::vector<Weighed> found;
  for (const types::Match& m : matches) {
    const double range = place.ranges[static_cast<std::size_t>(m.b)];
    if (range <= 0) continue;
    const Vector3d ray = R_place_view * rayOf(view, m.a), point = range * rayOf(place, m.b);
    const Vector3d across = direction.cross(ray);
    const double sine = across.norm();
    if (sine < 0.1) continue;  // the point is on the way
    const double length = point.cross(ray).dot(across) / (sine * sine);
    const double off = (point - length * direction).norm() * kRaySigma;
    const double deep = point.cross(ray).norm() * kRangeSigma;
    found.push_back({length, sine * sine / (off * off + deep * deep)});
  }
  return found;
}

/// Median inverse distance of the points seen nearest to the ray [1/m].
double inverseRangeBeside(const Vector3d& ray, const types::Features& view, std::vector<Landmark> points) {
  const auto nearest = points.begin() + kBeside;
  std::nth_element(points.begin(), nearest - 1, points.end(), [&](const Landmark& a, const Landmark& b) {
    return rayOf(view, a.match.a).dot(ray) > rayOf(view, b.match.a).dot(ray);
  });
  const auto middle = points.begin() + kBeside / 2;
  std::nth_element(points.begin(), middle, nearest,
                   [](const Landmark& a, const Landmark& b) { return a.fromView < b.fromView; });
  return 1 / middle->fromView;
}

}  // namespace

std::vector<Landmark> triangulated(const types::Features& view, const types::Features& place,
                                   std::span<const types::Match> matches,
                                   const Eigen::Isometry3d& T_place_view, double parallax) {
  std::vector<Landmark> points;
  const Vector3d t = T_place_view.translation();
  for (const types::Match& m : matches) {
    const Vector3d ray = T_place_view.linear() * rayOf(view, m.a), seen = rayOf(place, m.b);
    const Vector3d across = ray.cross(seen);
    if (across.norm() < std::sin(parallax)) continue;
    // The rays meet where fromPlace * seen = t + fromView * ray.
    const double fromView = -t.cross(seen).dot(across) / across.squaredNorm();
    const double fromPlace = -t.cross(ray).dot(across) / across.squaredNorm();
    if (fromView > 0 && fromPlace > 0) points.push_back({m, fromView, fromPlace});
  }
  return points;
}

std::optional<Length> lengthOf(const types::Features& view, const types::Features& place,
                               std::span<const types::Match> matches, const Eigen::Matrix3d& R_place_view,
                               const Eigen::Vector3d& direction_place) {
  if (place.ranges.empty() || direction_place.isZero()) return std::nullopt;
  std::vector<Weighed> sample = lengths(view, place, matches, R_place_view, direction_place);
  if (sample.size() < kFewestPoints) return std::nullopt;
  const double metres = weightedMedian(sample);
  if (metres <= 0) return std::nullopt;
  for (Weighed& w : sample) w.value = std::abs(w.value - metres);
  const double spread = 1.48 * weightedMedian(sample);  // a standard deviation, were it normal
  if (spread > kMostSpread * metres + kLengthFloor) return std::nullopt;
  const double found = 1.25 * spread / std::sqrt(static_cast<double>(sample.size()));  // of a median
  return Length{metres, std::hypot(found, kLengthShare * metres + kLengthFloor)};
}

types::Features inPlaceFrame(types::Features view, const Eigen::Matrix3d& R_place_view) {
  const Eigen::Matrix3f R = R_place_view.cast<float>();
  for (auto& bearing : view.bearings) bearing = (R * bearing).normalized();
  return view;
}

types::Features inPlaceFrame(types::Features view, const Eigen::Isometry3d& T_place_view,
                             const types::Features& place, std::span<const types::Match> matches) {
  if (view.bearings.empty() || place.bearings.empty()) return view;
  const auto points = triangulated(view, place, matches, T_place_view, kBesideParallax);
  if (points.size() < kBeside) return inPlaceFrame(std::move(view), T_place_view.linear());
  const types::Features seen = view;
  for (std::size_t i = 0; i < view.size(); ++i) {
    const Vector3d ray = rayOf(seen, static_cast<int>(i));
    const Vector3d moved =
        T_place_view.linear() * ray + inverseRangeBeside(ray, seen, points) * T_place_view.translation();
    view.bearings[i] = moved.normalized().cast<float>();
  }
  return view;
}

}  // namespace engram::pipeline
