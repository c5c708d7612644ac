// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// The rows of a map. Bytes: what the row is, its version (of the row as it is packed, the highest bit set),
// the content. The checksum is made right here: it guards against accidents, not against people.
#include "codec.h"
#include "engram/base/error.h"
#include "engram/map/map_content.h"
#include "engram/map/picture.h"
#include "engram/store/report_json.h"

#include <cstdlib>
#include <string>

namespace {

using namespace engram;
using store::Blob;
using store::RowKind;

constexpr std::uint64_t kId = 1;
constexpr std::uint8_t kPacked = 0x80;

Blob sealed(RowKind kind, std::uint8_t version, std::span<const std::uint8_t> content) {
  store::BlobWriter out(kind, version & 0x7f);
  out.raw(content.data(), content.size());
  if (version & kPacked) out.compress();
  return std::move(out).seal(kind == RowKind::kState ? 0 : kId);
}

/// What was read must be read again from what is written of it.
void require(bool holds) {
  if (!holds) std::abort();
}

void decode(RowKind kind, const Blob& row) {
  switch (kind) {
    case RowKind::kState: {
      const Blob again = store::encode(store::decodeState(row));
      require(store::encode(store::decodeState(again)) == again);
      break;
    }
    case RowKind::kPlace: {
      const map::Place place = store::decodePlace(row, kId);
      map::brokenRule(place);
      const Blob again = store::encode(place);
      require(store::encode(store::decodePlace(again, kId)) == again);
      break;
    }
    case RowKind::kMemory: {
      map::Place place;
      place.memory = store::decodeMemory(row, kId);
      map::brokenRule(place);
      const Blob again = store::encodeMemory(map::PlaceId(kId), place.memory);
      require(store::encodeMemory(map::PlaceId(kId), store::decodeMemory(again, kId)) == again);
      break;
    }
    case RowKind::kFeatures: {
      const Blob again = store::encodeFeatures(store::decodeFeatures(row, kId), kId);
      require(store::encodeFeatures(store::decodeFeatures(again, kId), kId) == again);
      break;
    }
    case RowKind::kView: {
      const map::View view = store::decodeView(row, kId);
      map::brokenRule(view);
      map::brokenPicture(view.jpeg);
      const Blob again = store::encode(view);
      require(store::encode(store::decodeView(again, kId)) == again);
      break;
    }
    case RowKind::kEdge: {
      const map::Edge edge = store::decodeEdge(row, kId);
      map::brokenRule(edge);
      const Blob again = store::encode(edge);
      require(store::encode(store::decodeEdge(again, kId)) == again);
      break;
    }
    case RowKind::kPath: {
      const map::PathPoint point = store::decodePathPoint(row, kId);
      map::brokenRule(point);
      const Blob again = store::encode(point, kId);
      require(store::encode(store::decodePathPoint(again, kId), kId) == again);
      break;
    }
    case RowKind::kDrive: {
      const Blob again = store::encode(store::decodeDrive(row, kId));
      require(store::encode(store::decodeDrive(again, kId)) == again);
      break;
    }
    case RowKind::kCounts:
      break;  // read by the store alone, with its table
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::span<const std::uint8_t> content(data + 2, size - 2);
  try {
    if (data[0] == 'J') {
      const std::string line(content.begin(), content.end());
      const std::string again = store::toJson(store::reportFromJson(line));
      try {
        store::reportFromJson(again);
      } catch (const base::Error&) {
        require(false);
      }
    } else if (std::string_view("SPMVETFD").find(static_cast<char>(data[0])) != std::string_view::npos) {
      const auto kind = static_cast<RowKind>(data[0]);
      decode(kind, sealed(kind, data[1], content));
    }
  } catch (const base::Error&) {
    // Refused: what it is for.
  }
  return 0;
}
