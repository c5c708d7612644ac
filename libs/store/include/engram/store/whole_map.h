// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/map_content.h"
#include "engram/store/drive.h"
#include "engram/types/frame_report.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace engram::store {

/// All that a map file holds, as a value: what tools of a keeper of maps change and write back as one.
struct WholeMap {
  map::MapHeader header;
  map::MapContent content;
  std::vector<Drive> drives;                ///< `id` is the position
  std::vector<types::FrameReport> records;  ///< of the images, those of one drive together
  std::uint64_t firstRecord = 0;            ///< number of the first of them
  /// What keepers have laid down beside the header, by name: see keeper/closures.h.
  std::map<std::string, std::string> notes;
};

/// CRC-32 of a row as the store writes it: equal things have equal ones.
std::uint32_t fingerprintOf(const map::Place& place);  ///< without its memory
std::uint32_t fingerprintOf(map::PlaceId id, const memory::PlaceMemory& memory);
std::uint32_t fingerprintOf(const map::View& view);
std::uint32_t fingerprintOf(const map::Edge& edge);
std::uint32_t fingerprintOf(const map::PathPoint& point, std::uint64_t index);

/// What the rows of a place take, with its memory, its views and its edges by halves [byte].
std::map<map::PlaceId, std::uint64_t> rowBytes(const map::MapContent& content);

}  // namespace engram::store
