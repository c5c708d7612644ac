// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "map_colours.h"

#include <algorithm>

namespace engram::exporters {

charts::Colour edgeColour(map::EdgeType type) {
  switch (type) {
    case map::EdgeType::kOdometry:
      return {120, 120, 120};
    case map::EdgeType::kLoop:
      return {213, 60, 30};
    case map::EdgeType::kRecognition:
      return {0, 114, 178};
    case map::EdgeType::kWeak:
      return {200, 170, 60};
    case map::EdgeType::kCompounded:
      return {150, 80, 160};
    case map::EdgeType::kDeadReckoning:
      return {190, 190, 190};
  }
  return {};
}

int largestLongTerm(const map::MapContent& content) {
  std::size_t largest = 1;
  for (const auto& [id, place] : content.places) largest = std::max(largest, place.memory->longTerm().size());
  return static_cast<int>(largest);
}

}  // namespace engram::exporters
