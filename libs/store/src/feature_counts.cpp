// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "feature_counts.h"

#include "codec.h"
#include "derived_rows.h"
#include "engram/base/error.h"

namespace engram::store {
namespace {

PlaceCounts counted(Connection& database, std::uint32_t id, std::uint32_t checksum) {
  Statement row(database, "SELECT data FROM memories WHERE id = $1");
  row.bind(1, std::uint64_t{id});
  if (!row.step()) return {};
  try {
    const memory::PlaceMemory memory = decodeMemory(row.blob(0), id);
    return {checksum, static_cast<std::uint32_t>(memory.longTerm().size()),
            static_cast<std::uint32_t>(memory.states.size())};
  } catch (const base::Error& e) {
    throw base::Error("map '" + database.path() + "' is damaged: memory of place " + std::to_string(id) +
                      ": " + e.what());
  }
}

}  // namespace

/// Empty where nothing can be read: what is missing is counted anew.
CountsByPlace keptCounts(Connection& database) {
  CountsByPlace counts;
  try {
    Statement row(database, "SELECT data FROM derived WHERE kind = $1 AND id = 0");
    row.bind(1, static_cast<std::uint64_t>(RowKind::kCounts));
    if (!row.step()) return counts;
    BlobReader in(row.blob(0), RowKind::kCounts, 1, 0);
    in.get<std::uint32_t>();
    const std::size_t n = in.count(10);
    for (std::size_t i = 0; i < n; ++i) {
      const auto id = in.get<std::uint32_t>();
      PlaceCounts& place = counts[id];
      place.checksum = in.get<std::uint32_t>();
      place.longTerm = static_cast<std::uint32_t>(in.varint(map::kMostIds));
      place.all = static_cast<std::uint32_t>(in.varint(map::kMostIds));
    }
    in.requireEnd();
  } catch (const base::Error&) {
    counts.clear();
  }
  return counts;
}

CountsByPlace countFeatures(Connection& database, int version) {
  const CountsByPlace kept = version >= 3 ? keptCounts(database) : CountsByPlace{};
  CountsByPlace counts;
  for (const auto& [id, checksum] : basesOf(database, map::DerivedKind::kPlaceWords)) {
    const auto known = kept.find(id);
    const bool holds = known != kept.end() && known->second.checksum == checksum;
    counts[id] = holds ? known->second : counted(database, id, checksum);
  }
  return counts;
}

FeatureCounts sumOf(const CountsByPlace& counts) {
  FeatureCounts sum;
  for (const auto& [id, place] : counts) {
    sum.longTerm += place.longTerm;
    sum.shortTerm += place.all - place.longTerm;
  }
  return sum;
}

void writeCounts(Connection& database, const CountsByPlace& counts) {
  BlobWriter out(RowKind::kCounts, 1);
  out.put(std::uint32_t{0});  // in the place of a basis: each place has its own
  out.varint(counts.size());
  for (const auto& [id, place] : counts) {
    out.put(id);
    out.put(place.checksum);
    out.varint(place.longTerm);
    out.varint(place.all);
  }
  const Blob row = std::move(out).seal(0);
  Statement(database, kPutDerived)
      .bind(1, static_cast<std::uint64_t>(RowKind::kCounts))
      .bind(2, std::uint64_t{0})
      .bind(3, row)
      .run();
}

}  // namespace engram::store
