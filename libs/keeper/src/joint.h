// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/store/whole_map.h"
#include "engram/types/match.h"
#include "engram/types/rel_pose.h"
#include "place_pairs.h"

#include <functional>
#include <vector>

namespace engram::keeper {

/// A place of b that was recognised at a place of a.
struct Joint {
  map::PlaceId a, b;
  types::RelPose T_a_b;               ///< of the two places
  std::vector<types::Match> matches;  ///< a = feature of the place of b, b = of that of a
  Eigen::Isometry3d T_maps = Eigen::Isometry3d::Identity();  ///< where it puts the map b in the frame of a
};

/// Every place of b that geometry recognises in a, and that no other place of a looks as much alike.
std::vector<Joint> recognised(const map::MapContent& a, const map::MapContent& b, const PlacePairs& pairs,
                              const std::function<void(double)>& progress);

/// Those that the largest number agrees with on where b lies, as far as the drift of odometry between them
/// allows; the one that most agree with first.
std::vector<Joint> agreeing(std::vector<Joint> joints, const map::MapContent& a, const PlacePairs& pairs);

/// How many places of b would lie within `beside` [m] of a place of a, each where the joint nearest to it in
/// b puts it. @param joints not empty
std::size_t besidePlaces(const std::vector<Joint>& joints, const map::MapContent& a, const map::MapContent& b,
                         double beside);

}  // namespace engram::keeper
