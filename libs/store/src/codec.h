// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "blob.h"
#include "engram/map/map_content.h"
#include "engram/store/drive.h"

namespace engram::store {

/// Numbers of the whole map, rewritten by every commit: rows that vanish are found by them.
struct MapState {
  std::uint64_t commits = 0;
  std::uint32_t nextPlace = 0, nextView = 0, nextEdge = 0;
  std::uint64_t places = 0, views = 0, edges = 0, path = 0, records = 0;
  memory::Redetections redetections;  ///< since version 2 of the row; without any, version 1 is written
  std::uint64_t firstRecord = 0;      ///< number of the oldest record; since version 3 of the row

  std::uint64_t nextRecord() const { return firstRecord + records; }
};

// Rows as sealed blobs. Floating point numbers keep every bit, so that a map read again equals the one
// written.
Blob encode(const MapState& state);
/// Without the memory, which has its own row. The standing came with version 2 of the row, joint errors with
/// version 3; a place of which there is nothing to say is written as version 1.
Blob encode(const map::Place& place);
Blob encodeMemory(map::PlaceId id, const memory::PlaceMemory& memory);
Blob encodeFeatures(const types::Features& features, std::uint64_t row);
Blob encode(const map::View& view);
Blob encode(const map::Edge& edge);
Blob encode(const map::PathPoint& point, std::uint64_t row);
Blob encode(const Drive& drive);

// The reverse; throw base::Error on any damage, without naming the row.
MapState decodeState(std::span<const std::uint8_t> row);
map::Place decodePlace(std::span<const std::uint8_t> row, std::uint64_t id);
memory::PlaceMemory decodeMemory(std::span<const std::uint8_t> row, std::uint64_t id);
types::Features decodeFeatures(std::span<const std::uint8_t> row, std::uint64_t id);
map::View decodeView(std::span<const std::uint8_t> row, std::uint64_t id);
map::Edge decodeEdge(std::span<const std::uint8_t> row, std::uint64_t id);
map::PathPoint decodePathPoint(std::span<const std::uint8_t> row, std::uint64_t index);
Drive decodeDrive(std::span<const std::uint8_t> row, std::uint64_t id);

}  // namespace engram::store
