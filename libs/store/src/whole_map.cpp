// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/store/whole_map.h"

#include "codec.h"
#include "engram/base/error.h"
#include "engram/store/report_json.h"
#include "rows.h"
#include "whole_rows.h"

#include <algorithm>
#include <cstring>
#include <string_view>

namespace engram::store {
namespace {

constexpr std::string_view kNotePrefix = "note.";

/// The checksum that ends each row.
std::uint32_t checksumOf(const Blob& row) {
  std::uint32_t crc = 0;
  std::memcpy(&crc, row.data() + row.size() - sizeof crc, sizeof crc);
  return crc;
}

/// Makes a table hold these rows and no others; those that are equal are not touched.
/// @param next the next row as number and bytes, by rising numbers; false when there is none
template <class Next>
void writeTable(Connection& database, const std::string& table, Next&& next) {
  std::map<std::uint64_t, Blob> put;
  std::vector<std::uint64_t> gone;
  {
    Statement known(database, ("SELECT id, data FROM " + table + " ORDER BY id").c_str());
    bool more = known.step();
    std::pair<std::uint64_t, Blob> row;
    while (next(row)) {
      for (; more && static_cast<std::uint64_t>(known.integer(0)) < row.first; more = known.step())
        gone.push_back(static_cast<std::uint64_t>(known.integer(0)));
      const bool there = more && static_cast<std::uint64_t>(known.integer(0)) == row.first;
      if (!there || !std::ranges::equal(known.blob(1), row.second)) put.insert(row);
      if (there) more = known.step();
    }
    for (; more; more = known.step()) gone.push_back(static_cast<std::uint64_t>(known.integer(0)));
  }
  Statement remove(database, ("DELETE FROM " + table + " WHERE id = $1").c_str());
  for (const std::uint64_t id : gone) remove.bind(1, id).run();
  Statement insert(database, ("INSERT INTO " + table +
                              " VALUES ($1, $2) ON CONFLICT (id) DO UPDATE SET data = excluded.data")
                                 .c_str());
  for (const auto& [id, row] : put) insert.bind(1, id).bind(2, row).run();
}

/// The rows of a container, as writeTable() takes them.
template <class Container, class Encode>
void writeAll(Connection& database, const std::string& table, const Container& items, Encode&& encoded) {
  auto at = items.begin();
  std::uint64_t index = 0;
  writeTable(database, table, [&](std::pair<std::uint64_t, Blob>& row) {
    if (at == items.end()) return false;
    row = encoded(*at, index++);
    ++at;
    return true;
  });
}

void writeRecords(Connection& database, const WholeMap& whole) {
  database.execute("DELETE FROM records");
  for (std::size_t i = 0; i < whole.records.size(); ++i)
    writeRecord(database, whole.firstRecord + i, toJson(whole.records[i]));
}

void writeNotes(Connection& database, const WholeMap& whole) {
  database.execute("DELETE FROM header");
  writeHeader(database, whole.header);
  Statement insert(database, "INSERT INTO header VALUES ($1, $2, $3)");
  for (const auto& [name, value] : whole.notes) {
    const std::string key = std::string(kNotePrefix) + name;
    insert.bind(1, key).bind(2, value).bind(3, std::uint64_t{crc32Of(key + '\n' + value)}).run();
  }
}

}  // namespace

void writeWhole(Connection& database, const WholeMap& whole) {
  const map::MapContent& c = whole.content;
  using Row = std::pair<std::uint64_t, Blob>;
  const auto byId = [](const auto& item, std::uint64_t) {
    return Row{item.first.value, encode(item.second)};
  };
  writeAll(database, "places", c.places, byId);
  writeAll(database, "memories", c.places, [](const auto& item, std::uint64_t) {
    return Row{item.first.value, encodeMemory(item.first, item.second.memory)};
  });
  writeAll(database, "views", c.views, byId);
  writeAll(database, "edges", c.edges, byId);
  writeAll(database, "path", c.path, [](const map::PathPoint& point, std::uint64_t i) {
    return Row{i, encode(point, i)};
  });
  writeAll(database, "drives", whole.drives, [](const Drive& drive, std::uint64_t i) {
    return Row{i, encode(drive)};
  });
  writeRecords(database, whole);
  writeNotes(database, whole);
  database.execute("DELETE FROM undo");
}

std::map<std::string, std::string> readNotes(Connection& database) {
  std::map<std::string, std::string> notes;
  Statement statement(database, "SELECT key, value FROM header ORDER BY key");  // header() has checked them
  while (statement.step())
    if (const std::string key = statement.text(0); key.starts_with(kNotePrefix))
      notes[key.substr(kNotePrefix.size())] = statement.text(1);
  return notes;
}

std::uint32_t fingerprintOf(const map::Place& place) { return checksumOf(encode(place)); }
std::uint32_t fingerprintOf(map::PlaceId id, const memory::PlaceMemory& memory) {
  return checksumOf(encodeMemory(id, memory));
}
std::uint32_t fingerprintOf(const map::View& view) { return checksumOf(encode(view)); }
std::uint32_t fingerprintOf(const map::Edge& edge) { return checksumOf(encode(edge)); }
std::uint32_t fingerprintOf(const map::PathPoint& point, std::uint64_t index) {
  return checksumOf(encode(point, index));
}

std::map<map::PlaceId, std::uint64_t> rowBytes(const map::MapContent& content) {
  std::map<map::PlaceId, std::uint64_t> bytes;
  for (const auto& [id, place] : content.places)
    bytes[id] = encode(place).size() + encodeMemory(id, place.memory).size();
  for (const auto& [id, view] : content.views) bytes[view.place] += encode(view).size();
  for (const auto& [id, edge] : content.edges) {
    const std::uint64_t half = encode(edge).size() / 2;
    bytes[edge.a] += half;
    bytes[edge.b] += half;
  }
  return bytes;
}

}  // namespace engram::store
