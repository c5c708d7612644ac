// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/memory/place_memory.h"
#include "steps.h"

#include <utility>
#include <vector>

namespace engram::pipeline {

// What places learn from images whose pose is known: new features, and how far the old ones are.

/// A view that a place is to learn.
struct Lesson {
  base::PlaceId place;
  types::Features view;
  types::RelPose T_place_robot;  ///< where it was taken
};

/// The place learns from a view that it matches.
types::MemoryChange teach(Run& run, const memory::MemoryModel& memory, const Lesson& lesson,
                          const PlaceMatch& match);

/// A place learns how far the features are that a view of it matches from elsewhere.
void measureFrom(Run& run, const types::Features& view, const Link& link,
                 const types::RelPose& T_place_robot);
/// A new place and those around the anchor that its view matches tell each other how far their features are.
void measureWith(Run& run, const types::Features& view, const Verified& verified, base::PlaceId made);

/// Features of place a that the view which made place b matches, and those that b made of them.
std::vector<std::pair<std::uint32_t, std::uint32_t>> correspondences(const Run& run, const PlaceMatch& match,
                                                                     base::PlaceId a, base::PlaceId b);

}  // namespace engram::pipeline
