// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "map_reader.h"

#include "engram/base/error.h"
#include "engram/base/text.h"
#include "engram/map/picture.h"
#include "engram/store/report_json.h"

#include <charconv>
#include <cmath>
#include <map>
#include <utility>

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

/// A map can do without: a picture that cannot be shown is left out.
void MapReader::checkPicture(const map::View& view) {
  if (view.jpeg.empty()) return;
  if (const std::string rule = map::brokenPicture(view.jpeg); !rule.empty())
    problem("view " + std::to_string(view.id.value) + ": its picture: " + rule);
}

void MapReader::requireLastRecord(const MapState& state) {
  const auto last = database_.number("SELECT coalesce(max(id), -1) FROM records");
  const bool fits =
      state.records == 0 ? last < 0 : static_cast<std::uint64_t>(last) + 1 == state.nextRecord();
  if (!fits)
    throw base::Error("map '" + database_.path() + "' is damaged: record " + std::to_string(last) +
                      " is the last one where " + std::to_string(state.nextRecord()) + " were written");
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
      throw base::Error("map '" + database_.path() + "' is damaged: header " + base::quoted(key) +
                        ": its checksum is wrong");
    if (!values.emplace(key, value).second)
      throw base::Error("map '" + database_.path() + "' is damaged: header " + base::quoted(key) +
                        " is there twice");
  }
  const auto get = [&](const std::string& key) {
    const auto it = values.find(key);
    if (it == values.end())
      throw base::Error("map '" + database_.path() + "' is damaged: header '" + key + "' is missing");
    return it->second;
  };
  const auto number = [&](const std::string& key) {
    const std::string text = get(key);
    double value = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc() || end != text.data() + text.size())
      throw base::Error("map '" + database_.path() + "' is damaged: header '" + key + "' is not a number");
    return value;
  };
  const auto smallNumber = [&](const std::string& key) {
    const double value = number(key);
    if (!(value >= 0 && value <= map::kMostDescriptorDim && value == std::floor(value)))
      throw base::Error("map '" + database_.path() + "' is damaged: header '" + key + "' is out of range");
    return static_cast<int>(value);
  };
  map::MapHeader h;
  h.engramVersion = get("engram_version");
  h.camera = get("camera");
  h.extractor = get("extractor");
  const int kind = smallNumber("descriptor_kind");
  if (kind > static_cast<int>(types::DescriptorKind::kBinary))
    throw base::Error("map '" + database_.path() + "' is damaged: its descriptors are of an unknown kind");
  h.descriptorKind = static_cast<types::DescriptorKind>(kind);
  h.descriptorDim = smallNumber("descriptor_dim");
  h.memoryModel = get("memory_model");
  h.parameters = get("parameters");
  h.firstStamp = number("first_stamp");
  if (const std::string rule = map::brokenRule(h); !rule.empty())
    throw base::Error("map '" + database_.path() + "' is damaged: header: " + rule);
  return h;
}

void MapReader::readMemories(const MapState& s, map::MapContent& c) {
  forEachRow("SELECT id, data FROM memories ORDER BY id", "memory of place", s.places,
             [&](std::uint64_t id, Statement& row) {
               memory::PlaceMemory memory = decodeMemory(row.blob(1), id);
               const auto it = c.places.find(map::PlaceId(static_cast<std::uint32_t>(id)));
               if (it == c.places.end()) throw base::Error("its place is missing");
               it->second.memory = std::move(memory);
             });
}

void MapReader::readViews(const MapState& s, map::MapContent& c) {
  forEachRow("SELECT id, data FROM views ORDER BY id", "view", s.views,
             [&](std::uint64_t id, Statement& row) {
               map::View view = decodeView(row.blob(1), id);
               if (problems_ != nullptr) checkPicture(view);
               c.views.emplace(view.id, std::move(view));
             });
}

map::MapContent MapReader::content(std::shared_ptr<const map::OnDemand<memory::PlaceMemory>::Source> memories,
                                   bool withViews) {
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
  if (memories)
    forEachRow("SELECT id FROM memories ORDER BY id", "memory of place", s.places,
               [&](std::uint64_t id, Statement&) {
                 const auto it = c.places.find(map::PlaceId(static_cast<std::uint32_t>(id)));
                 if (it == c.places.end()) throw base::Error("its place is missing");
                 it->second.memory = {memories, static_cast<std::uint32_t>(id)};
               });
  else
    readMemories(s, c);
  if (withViews) readViews(s, c);
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
  for (const std::string& rule : map::brokenRules(header(), c)) problem(rule);
  return c;
}

std::vector<types::FrameReport> MapReader::records() {
  const MapState s = state();
  std::uint64_t next = s.firstRecord;
  std::vector<types::FrameReport> records;
  forEachRow("SELECT id, json, crc FROM records ORDER BY id", "record", s.records,
             [&](std::uint64_t id, Statement& row) {
               const std::uint64_t expected = std::exchange(next, id + 1);
               if (id != expected) throw base::Error("the one before it is missing");
               const std::string json = row.text(1);
               if (crc32Of(json) != static_cast<std::uint64_t>(row.integer(2)))
                 throw base::Error("its checksum is wrong");
               records.push_back(reportFromJson(json));
               if (!std::isfinite(records.back().stamp)) throw base::Error("its time stamp is not finite");
             });
  return records;
}

std::vector<Drive> MapReader::drives() {
  std::vector<Drive> drives;
  Statement statement(database_, "SELECT id, data FROM drives ORDER BY id");
  while (statement.step()) {
    const auto id = static_cast<std::uint64_t>(statement.integer(0));
    try {
      if (id != drives.size()) throw base::Error("the one before it is missing");
      drives.push_back(decodeDrive(statement.blob(1), id));
    } catch (const base::Error& e) {
      problem("drive " + std::to_string(id) + ": " + e.what());
    }
  }
  return drives;
}

}  // namespace engram::store
