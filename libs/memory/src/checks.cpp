// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "checks.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace engram::memory {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("MemoryModel: " + what); }

bool claim(std::vector<bool>& taken, int index) {
  if (index < 0 || static_cast<std::size_t>(index) >= taken.size()) return false;
  const bool isFree = !taken[static_cast<std::size_t>(index)];
  taken[static_cast<std::size_t>(index)] = true;
  return isFree;
}

}  // namespace

void checkView(const types::Features& view) {
  if (view.descriptors.size() != view.size())
    refuse("the view has another number of descriptors than keypoints");
  if (!view.bearings.empty() && view.bearings.size() != view.size())
    refuse("the view has another number of bearings than keypoints");
  if (!view.ranges.empty() && view.ranges.size() != view.size())
    refuse("the view has another number of ranges than keypoints");
  for (const auto& keypoint : view.keypoints)
    if (!std::isfinite(keypoint.response)) refuse("a response of the view is not finite");
}

void checkUpdate(const PlaceMemory& memory, const types::Features& view,
                 std::span<const types::Match> matches) {
  checkView(view);
  if (memory.states.size() != memory.features.size())
    refuse("states and features of the memory differ in number");
  if (!memory.features.empty() && !view.empty()) {
    const types::Descriptors layout(view.descriptors.kind(), view.descriptors.dim());
    if (!memory.features.descriptors.sameLayout(types::quantised(layout)))
      refuse("the view has descriptors of another kind than the memory");
    if (memory.features.bearings.empty() != view.bearings.empty())
      refuse("either the view or the memory has bearings, but not both");
  }
  std::vector<bool> takenA(view.size()), takenB(memory.features.size());
  for (const auto& match : matches) {
    if (!claim(takenA, match.a) || !claim(takenB, match.b))
      refuse("matches must be one-to-one and in range; (" + std::to_string(match.a) + ", " +
             std::to_string(match.b) + ") is not");
    if (!std::isfinite(match.distance) || match.distance < 0) refuse("a match has no proper distance");
  }
}

}  // namespace engram::memory
