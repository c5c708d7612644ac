// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "place_lessons.h"

#include "engram/pipeline/landmarks.h"
#include "place_rules.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <span>

namespace engram::pipeline {
namespace {

/// A way is long enough to tell how far points are when its length is known to this share of it.
constexpr double kSharpWay = 0.15;
constexpr double kShortestWay = 0.15;    // [m]
constexpr double kRangeParallax = 0.05;  // [rad] between the rays of a point whose range is kept

/// Where a fresh memory keeps a feature of its view: it numbers them as they come, without those that it
/// found to be duplicates. -1 for those.
int indexInFresh(const memory::PlaceMemory& memory, int featureOfView) {
  const auto id = static_cast<std::uint32_t>(featureOfView);
  const auto at =
      std::find_if(memory.states.begin(), memory.states.end(), [id](const auto& s) { return s.id == id; });
  return at == memory.states.end() ? -1 : static_cast<int>(at - memory.states.begin());
}

Eigen::Isometry3d cameraSeenFrom(const Run& run, const Link& link, const types::RelPose& T_place_robot) {
  const Eigen::Vector3d eye = run.perception.eye();
  Eigen::Isometry3d T_place_view = T_place_robot.T_a_b;
  T_place_view.linear() = link.match.R_place_view;
  T_place_view.translation() += T_place_robot.T_a_b.linear() * eye - eye;
  return T_place_view;
}

bool isSharp(const types::RelPose& way) {
  const double length = way.T_a_b.translation().norm();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(way.cov.topLeftCorner<3, 3>());
  return length > kShortestWay && std::sqrt(axes.eigenvalues()[2]) < kSharpWay * length;
}

/// The points that a view and a place see from the two ends of a way that is known well enough.
std::vector<Landmark> landmarks(const Run& run, const types::Features& view, const Link& link,
                                const types::RelPose& T_place_robot) {
  const types::Features& place = run.map.place(link.place).memory->features;
  if (view.bearings.empty() || place.bearings.empty() || !isSharp(T_place_robot)) return {};
  return triangulated(view, place, link.match.matches, cameraSeenFrom(run, link, T_place_robot),
                      kRangeParallax);
}

void measure(Run& run, base::PlaceId place, std::span<const Landmark> points) {
  std::vector<std::pair<int, float>> ranges;
  for (const Landmark& p : points) ranges.emplace_back(p.match.b, static_cast<float>(p.fromPlace));
  run.map.measure(place, ranges);
}

}  // namespace

void measureFrom(Run& run, const types::Features& view, const Link& link,
                 const types::RelPose& T_place_robot) {
  measure(run, link.place, landmarks(run, view, link, T_place_robot));
}

void measureWith(Run& run, const types::Features& view, const Verified& verified, base::PlaceId made) {
  if (!run.robot.metric()) return;
  for (const Link& link : verified.links) {
    if (!link.match.verified() || isClosure(run, link.place)) continue;
    const auto points = landmarks(run, view, link, expectedAt(run, link.place));
    measure(run, link.place, points);
    std::vector<std::pair<int, float>> ranges;
    for (const Landmark& p : points)
      if (const int i = indexInFresh(run.map.place(made).memory, p.match.a); i >= 0)
        ranges.emplace_back(i, static_cast<float>(p.fromView));
    run.map.measure(made, ranges);
  }
}

types::MemoryChange teach(Run& run, const memory::MemoryModel& memory, const Lesson& lesson,
                          const PlaceMatch& match) {
  const auto T_place_view = cameraSeenFrom(run, {lesson.place, match}, lesson.T_place_robot);
  const types::Features& known = run.map.place(lesson.place).memory->features;
  return run.map.remember(lesson.place, memory, inPlaceFrame(lesson.view, T_place_view, known, match.matches),
                          match.matches);
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> correspondences(const Run& run, const PlaceMatch& match,
                                                                     base::PlaceId a, base::PlaceId b) {
  const auto& statesA = run.map.place(a).memory->states;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const auto& m : match.matches)
    if (indexInFresh(run.map.place(b).memory, m.a) >= 0)
      pairs.emplace_back(statesA[static_cast<std::size_t>(m.b)].id, static_cast<std::uint32_t>(m.a));
  return pairs;
}

}  // namespace engram::pipeline
