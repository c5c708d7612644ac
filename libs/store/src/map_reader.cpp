// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "map_reader.h"

#include "engram/base/error.h"
#include "engram/store/report_json.h"

#include <cstdlib>
#include <map>

namespace engram::store {

void MapReader::problem(const std::string& what) {
  if (problems_ == nullptr) throw base::Error("map '" + database_.path() + "' is damaged: " + what);
  problems_->push_back(what);
}

/// Calls read(id, statement) for the rows of `sql`, whose first column is the id.
template <class Read>
void MapReader::forEachRow(const char* sql, const std::string& what, std::uint64_t expected, Read&& read) {
  std::uint64_t rows = 0;
  Statement statement(database_, sql);
  for (; statement.step(); ++rows) {
    const auto id = static_cast<std::uint64_t>(statement.integer(0));
    try {
      if (id >= base::PlaceId::kInvalid) throw base::Error("its number is out of range");
      read(id, statement);
    } catch (const base::Error& e) {
      problem(what + " " + std::to_string(id) + ": " + e.what());
    }
  }
  if (rows != expected)
    problem(std::to_string(rows) + " rows of the kind '" + what + "' where " + std::to_string(expected) +
            " were written");
}

MapState MapReader::state() {
  Statement statement(database_, "SELECT data FROM state WHERE id = 0");
  const bool found = statement.step();  // a disk that cannot be read is no damage of the map
  try {
    if (!found) throw base::Error("it is missing");
    return decodeState(statement.blob(0));
  } catch (const base::Error& e) {
    throw base::Error("map '" + database_.path() + "' is damaged: the row of totals: " + e.what());
  }
}

map::MapHeader MapReader::header() {
  std::map<std::string, std::string> values;
  Statement statement(database_, "SELECT key, value, crc FROM header");
  while (statement.step()) {
    const std::string key = statement.text(0), value = statement.text(1);
    if (crc32Of(key + '\n' + value) != static_cast<std::uint64_t>(statement.integer(2)))
      throw base::Error("map '" + database_.path() + "' is damaged: header '" + key +
                        "': its checksum is wrong");
    values[key] = value;
  }
  const auto get = [&](const std::string& key) {
    const auto it = values.find(key);
    if (it == values.end())
      throw base::Error("map '" + database_.path() + "' is damaged: header '" + key + "' is missing");
    return it->second;
  };
  map::MapHeader h;
  h.engramVersion = get("engram_version");
  h.camera = get("camera");
  h.extractor = get("extractor");
  h.descriptorKind =
      static_cast<types::DescriptorKind>(std::strtol(get("descriptor_kind").c_str(), nullptr, 10));
  h.descriptorDim = static_cast<int>(std::strtol(get("descriptor_dim").c_str(), nullptr, 10));
  h.memoryModel = get("memory_model");
  h.parameters = get("parameters");
  h.firstStamp = std::strtod(get("first_stamp").c_str(), nullptr);
  return h;
}

map::MapContent MapReader::content() {
  const MapState s = state();
  map::MapContent c;
  c.nextPlace = s.nextPlace;
  c.nextView = s.nextView;
  c.nextEdge = s.nextEdge;
  c.redetections = s.redetections;
  forEachRow("SELECT id, data FROM places ORDER BY id", "place", s.places,
             [&](std::uint64_t id, Statement& row) {
               map::Place place = decodePlace(row.blob(1), id);
               c.places.emplace(place.id, std::move(place));
             });
  forEachRow("SELECT id, data FROM memories ORDER BY id", "memory of place", s.places,
             [&](std::uint64_t id, Statement& row) {
               memory::PlaceMemory memory = decodeMemory(row.blob(1), id);
               const auto it = c.places.find(map::PlaceId(static_cast<std::uint32_t>(id)));
               if (it == c.places.end()) throw base::Error("its place is missing");
               it->second.memory = std::move(memory);
             });
  forEachRow("SELECT id, data FROM views ORDER BY id", "view", s.views,
             [&](std::uint64_t id, Statement& row) {
               map::View view = decodeView(row.blob(1), id);
               c.views.emplace(view.id, std::move(view));
             });
  forEachRow("SELECT id, data FROM edges ORDER BY id", "edge", s.edges,
             [&](std::uint64_t id, Statement& row) {
               map::Edge edge = decodeEdge(row.blob(1), id);
               c.edges.emplace(edge.id, std::move(edge));
             });
  forEachRow("SELECT id, data FROM path ORDER BY id", "path point", s.path,
             [&](std::uint64_t id, Statement& row) {
               if (id != c.path.size()) throw base::Error("the one before it is missing");
               c.path.push_back(decodePathPoint(row.blob(1), id));
             });
  for (const std::string& rule : map::brokenRules(c)) problem(rule);
  return c;
}

std::vector<types::FrameReport> MapReader::records() {
  std::vector<types::FrameReport> records;
  forEachRow("SELECT id, json, crc FROM records ORDER BY id", "record", state().records,
             [&](std::uint64_t, Statement& row) {
               const std::string json = row.text(1);
               if (crc32Of(json) != static_cast<std::uint64_t>(row.integer(2)))
                 throw base::Error("its checksum is wrong");
               records.push_back(reportFromJson(json));
             });
  return records;
}

}  // namespace engram::store
