// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/place_truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace engram::evaluation {
namespace {

int nearestPlace(const SurveyedPlaces& places, const Eigen::Vector3d& position) {
  const auto nearer = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return (a - position).squaredNorm() < (b - position).squaredNorm();
  };
  const auto at = std::min_element(places.positions.begin(), places.positions.end(), nearer);
  return static_cast<int>(at - places.positions.begin());
}

}  // namespace

double chainPosition(const SurveyedPlaces& places, int nearest, const Eigen::Vector3d& position) {
  const auto& from = places.positions[static_cast<std::size_t>(nearest)];
  double best = nearest, bestDistance = (position - from).norm();
  for (const int step : {-1, 1}) {
    const int other = places.adjacency.along(nearest, step);
    if (other < 0) continue;
    const Eigen::Vector3d way = places.positions[static_cast<std::size_t>(other)] - from;
    if (way.squaredNorm() == 0) continue;
    const double share = std::clamp((position - from).dot(way) / way.squaredNorm(), 0.0, 1.0);
    const double distance = (position - from - share * way).norm();
    if (distance >= bestDistance) continue;
    bestDistance = distance;
    best = nearest + step * share;
  }
  return best;
}

std::optional<PlaceError> placeError(const Truth& truth, double stamp, const SurveyedPlaces& places,
                                     int place, double peak) {
  const std::size_t n = places.positions.size();
  if (places.adjacency.size() != n)
    throw std::invalid_argument("placeError: another number of positions than places");
  const auto position = truth.position(stamp);
  if (!position || n == 0) return std::nullopt;
  if (place < 0 || static_cast<std::size_t>(place) >= n)
    throw std::invalid_argument("placeError: no such place");
  PlaceError error;
  error.truePlace = nearestPlace(places, *position);
  error.truePeak = chainPosition(places, error.truePlace, *position);
  error.hops = belief::hopDistance(places.adjacency, place, error.truePlace, static_cast<int>(n));
  error.metres = (places.positions[static_cast<std::size_t>(place)] - *position).norm();
  const int difference = error.truePlace - place;
  if (places.adjacency.along(place, difference) == error.truePlace && std::abs(difference) <= error.hops)
    error.places = std::abs(peak - error.truePeak);
  else
    error.places = error.hops >= 0 ? error.hops : std::numeric_limits<double>::infinity();
  const bool near = error.hops >= 0 && error.hops <= 1 + truth.options().margin;
  error.verdict = near || error.metres <= truth.options().radius ? Verdict::kRight : Verdict::kWrong;
  return error;
}

}  // namespace engram::evaluation
