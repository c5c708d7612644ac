// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "salvage.h"

#include "engram/base/error.h"
#include "engram/store/report_json.h"

#include <algorithm>
#include <cstdlib>
#include <functional>

namespace engram::store {
namespace {

constexpr std::uint64_t kIdEnd = base::PlaceId::kInvalid;
/// So many numbers are tried one by one where nothing tells how many there are.
constexpr std::uint64_t kGapTried = 5000;
constexpr std::uint64_t kHeaderRows = 8;

using Take = std::function<void(std::uint64_t, Statement&)>;

/// All rows of a table that can be reached: from the front, from the back, and between these one by one.
class TableReader {
 public:
  TableReader(Database& database, const std::string& table, const std::string& columns)
      : database_(database), select_("SELECT id, " + columns + " FROM " + table) {}

  /// @param limit numbers are below it
  void read(std::uint64_t limit, const Take& take) {
    if (!scan(" LIMIT 0", take)) return;  // there is no such table
    if (scan(" ORDER BY id", take)) return;
    const std::uint64_t first = seen_.empty() ? 0 : *seen_.rbegin() + 1;
    scan(" ORDER BY id DESC", take);
    const auto behind = seen_.lower_bound(first);
    const std::uint64_t end = behind == seen_.end() ? limit : *behind;
    for (std::uint64_t id = first; id < end; ++id) scan(" WHERE id = " + std::to_string(id), take);
  }

 private:
  /// Whether it came to the end.
  bool scan(const std::string& rest, const Take& take) {
    try {
      Statement rows(database_, (select_ + rest).c_str());
      while (rows.step()) {
        const auto id = static_cast<std::uint64_t>(rows.integer(0));
        if (id >= kIdEnd) continue;
        if (!seen_.insert(id).second) return false;  // met from the other side, or pages that go in circles
        take(id, rows);
      }
      return true;
    } catch (const base::Error&) {
      return false;
    }
  }

  Database& database_;
  std::string select_;
  std::set<std::uint64_t> seen_;
};

struct Table {
  const char *name, *kind, *columns;
  std::uint64_t limit;
};

void readRows(Database& database, Salvage& out, const Table& table, const Take& take) {
  TableReader(database, table.name, table.columns).read(table.limit, [&](std::uint64_t id, Statement& row) {
    try {
      take(id, row);
    } catch (const base::Error&) {
      out.bad[table.kind].insert(id);
    }
  });
}

void readHeader(Database& database, Salvage& out) {
  std::map<std::string, std::string> values;
  TableReader(database, "(SELECT rowid AS id, key, value, crc FROM header)", "key, value, crc")
      .read(kHeaderRows + 1, [&](std::uint64_t, Statement& row) {
        const std::string key = row.text(1), value = row.text(2);
        if (crc32Of(key + '\n' + value) == static_cast<std::uint64_t>(row.integer(3))) values[key] = value;
      });
  const auto get = [&](const char* key) {
    if (!values.contains(key)) out.lostHeaders.insert(key);
    return values[key];
  };
  map::MapHeader& h = out.header;
  h.engramVersion = get("engram_version");
  h.camera = get("camera");
  h.extractor = get("extractor");
  h.descriptorKind = static_cast<types::DescriptorKind>(std::atoi(get("descriptor_kind").c_str()));
  h.descriptorDim = std::atoi(get("descriptor_dim").c_str());
  h.memoryModel = get("memory_model");
  h.parameters = get("parameters");
  h.firstStamp = std::strtod(get("first_stamp").c_str(), nullptr);
}

void readState(Database& database, Salvage& out) {
  try {
    Statement row(database, "SELECT data FROM state WHERE id = 0");
    if (row.step()) out.state = decodeState(row.blob(0));
  } catch (const base::Error&) {
    out.state.reset();
  }
}

MapState unknownState() {
  MapState s;
  s.nextPlace = s.nextView = s.nextEdge = kGapTried;
  s.path = s.records = kGapTried;
  return s;
}

void readPlaces(Database& database, const MapState& s, Salvage& out) {
  auto& places = out.content.places;
  readRows(database, out, {"places", "place", "data", s.nextPlace}, [&](std::uint64_t id, Statement& row) {
    map::Place place = decodePlace(row.blob(1), id);
    places.emplace(place.id, std::move(place));
  });
  readRows(database, out, {"memories", "memory", "data", s.nextPlace}, [&](std::uint64_t id, Statement& row) {
    memory::PlaceMemory memory = decodeMemory(row.blob(1), id);
    out.memories.insert(id);
    const auto place = places.find(map::PlaceId(static_cast<std::uint32_t>(id)));
    if (place != places.end())
      place->second.memory = std::move(memory);
    else
      out.bad["place"].insert(id);
  });
}

/// Where the header is lost, the memories tell what it said of their descriptors. Where they are lost too,
/// nothing is left that any value could contradict.
void inferDescriptors(Salvage& out) {
  map::MapHeader& h = out.header;
  if (!out.lostHeaders.contains("descriptor_kind") && !out.lostHeaders.contains("descriptor_dim")) return;
  h.descriptorDim = std::max(1, h.descriptorDim);
  for (const auto& [id, place] : out.content.places) {
    const types::Descriptors& kept = place.memory->features.descriptors;
    if (!out.memories.contains(id.value) || kept.dim() == 0) continue;
    h.descriptorKind = kept.kind();
    h.descriptorDim = kept.dim();
    return;
  }
}

void readGraph(Database& database, const MapState& s, Salvage& out) {
  readRows(database, out, {"views", "view", "data", s.nextView}, [&](std::uint64_t id, Statement& row) {
    map::View view = decodeView(row.blob(1), id);
    out.content.views.emplace(view.id, std::move(view));
  });
  readRows(database, out, {"edges", "edge", "data", s.nextEdge}, [&](std::uint64_t id, Statement& row) {
    map::Edge edge = decodeEdge(row.blob(1), id);
    out.content.edges.emplace(edge.id, std::move(edge));
  });
  readRows(database, out, {"path", "path point", "data", s.path},
           [&](std::uint64_t id, Statement& row) { out.path.emplace(id, decodePathPoint(row.blob(1), id)); });
}

void readDrives(Database& database, const MapState& s, Salvage& out) {
  readRows(database, out, {"records", "record", "json, crc", s.nextRecord()},
           [&](std::uint64_t id, Statement& row) {
             const std::string json = row.text(1);
             if (crc32Of(json) != static_cast<std::uint64_t>(row.integer(2)))
               throw base::Error("its checksum is wrong");
             reportFromJson(json);
             out.records.emplace(id, json);
           });
  readRows(database, out, {"drives", "drive", "data", kGapTried},
           [&](std::uint64_t id, Statement& row) { out.drives.emplace(id, decodeDrive(row.blob(1), id)); });
}

}  // namespace

std::size_t Salvage::rows() const {
  return content.places.size() + memories.size() + content.views.size() + content.edges.size() + path.size() +
         records.size() + drives.size();
}

Salvage salvage(Database& database) {
  Salvage out;
  readHeader(database, out);
  readState(database, out);
  const MapState limits = out.state.value_or(unknownState());
  readPlaces(database, limits, out);
  inferDescriptors(out);
  readGraph(database, limits, out);
  readDrives(database, limits, out);
  return out;
}

}  // namespace engram::store
