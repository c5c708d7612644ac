// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/keeper/configuration.h"
#include "engram/map/topological_map.h"
#include "engram/store/whole_map.h"
#include "sample_map.h"

#include <vector>

namespace engram::testing {

/// The header of a picture of 16 x 16 pixels.
inline const std::vector<std::uint8_t> kTinyPicture = {
    0xff, 0xd8, 0xff, 0xc0, 0, 17, 8, 0, 16, 0, 16, 3, 1, 0x22, 0, 2, 0x11, 1, 3, 0x11, 1, 0xff, 0xd9};

/// A ring of n places that was driven twice: session 0 made it, session 1 went round it and made one more
/// place beside each `everyth`, joined to it by a recognition.
inline store::WholeMap twoDrives(int n, int everyth) {
  map::TopologicalMap map = ringMap(n);
  base::Rng rng(11);
  for (int i = 0; i < n; ++i) {
    const map::PlaceId old(static_cast<std::uint32_t>(i));
    map::PlaceId at = old;
    if (i % everyth == 0) {
      map::Place p;
      p.T_map_place = map.place(old).T_map_place * planarPose(0.3, 0.1, 0.02);
      p.memory = randomMemory(rng, 20, 1);
      p.createdStamp = 1000 + i;
      p.createdLabel = "second_" + std::to_string(i) + ".png";
      p.session = 1;
      at = map.addPlace(std::move(p));
      map.addEdge({.type = map::EdgeType::kRecognition,
                   .a = old,
                   .b = at,
                   .T_a_b = relPose(planarPose(0.3, 0.1, 0.02)),
                   .correspondences = {{0, 1}, {3, 4}, {5, 6}}});
    }
    map.addView({.place = at, .stamp = 1000.0 + i, .label = "w", .session = 1, .jpeg = kTinyPicture});
    map.addPathPoint({.session = 1, .stamp = 1000.0 + i, .anchor = at});
  }
  store::WholeMap whole;
  whole.header.extractor = "surf";
  whole.header.engramVersion = "0.1.0";
  whole.header.descriptorDim = 64;
  whole.header.memoryModel = "fsh";
  whole.content = map.content();
  for (std::uint32_t d = 0; d < 2; ++d) {
    store::Drive drive{.id = d, .session = static_cast<int>(d), .source = "drive", .fingerprint = 7 + d};
    drive.firstRecord = d * static_cast<std::uint64_t>(n);
    drive.images = static_cast<std::uint64_t>(n);
    drive.finished = true;
    whole.drives.push_back(drive);
    for (int i = 0; i < n; ++i) {
      types::FrameReport report;
      report.index = static_cast<std::uint64_t>(i);
      report.stamp = 100.0 + 900.0 * d + i;
      report.label = "r.png";
      report.place = map.path()[d * static_cast<std::size_t>(n) + static_cast<std::size_t>(i)].anchor;
      whole.records.push_back(report);
    }
  }
  return whole;
}

inline bool isSound(const map::MapContent& content) { return map::brokenRules(content).empty(); }

inline std::size_t parts(const map::MapContent& content) {
  return map::TopologicalMap(content).components().size();
}

}  // namespace engram::testing
