// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/store/map_file.h"

#include "database.h"
#include "engram/base/error.h"
#include "engram/store/report_json.h"
#include "map_reader.h"

#include <cstdio>
#include <filesystem>
#include <fstream>

namespace engram::store {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kApplicationId = 0x456E676D;  // "Engm"; bytes 68 to 71 of the file

constexpr const char* kSchema = R"(
  PRAGMA application_id = 0x456E676D;
  PRAGMA user_version = 1;
  CREATE TABLE header   (key TEXT NOT NULL, value TEXT NOT NULL, crc INTEGER NOT NULL);
  CREATE TABLE state    (id INTEGER PRIMARY KEY, data BLOB NOT NULL);
  CREATE TABLE places   (id INTEGER PRIMARY KEY, data BLOB NOT NULL);
  CREATE TABLE memories (id INTEGER PRIMARY KEY, data BLOB NOT NULL);
  CREATE TABLE views    (id INTEGER PRIMARY KEY, data BLOB NOT NULL);
  CREATE TABLE edges    (id INTEGER PRIMARY KEY, data BLOB NOT NULL);
  CREATE TABLE path     (id INTEGER PRIMARY KEY, data BLOB NOT NULL);
  CREATE TABLE records  (id INTEGER PRIMARY KEY, json TEXT NOT NULL, crc INTEGER NOT NULL);
)";
static_assert(kFormatVersion == 1, "change user_version above too");

/// Does the file begin like a map? Without SQLite, so that damaged maps may be overwritten too.
bool looksLikeMap(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string head(4097, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  // At most a page of zeros: the power failed before the first page was on the disk.
  if (head.size() <= 4096 && head.find_first_not_of('\0') == std::string::npos) return true;
  return head.size() >= 72 && head.starts_with("SQLite format 3") && head.substr(68, 4) == "Engm";
}

void removeOld(const std::string& path, bool overwrite) {
  if (!overwrite)
    throw base::Error("map '" + path + "' exists already. Extend it, overwrite it, or choose another name");
  if (!fs::is_regular_file(path) || !looksLikeMap(path))
    throw base::Error("'" + path + "' exists and is not an Engram map: it is not overwritten");
  std::error_code error;
  for (const char* suffix : {"", "-wal", "-shm", "-journal"})
    if (!fs::remove(path + suffix, error) && error)
      throw base::Error("cannot overwrite map '" + path + "': " + error.message());
}

std::string exact(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

void writeHeader(Database& database, const map::MapHeader& h) {
  Statement insert(database, "INSERT INTO header VALUES (?, ?, ?)");
  const std::pair<const char*, std::string> rows[] = {
      {"engram_version", h.engramVersion},
      {"camera", h.camera},
      {"extractor", h.extractor},
      {"descriptor_kind", std::to_string(static_cast<int>(h.descriptorKind))},
      {"descriptor_dim", std::to_string(h.descriptorDim)},
      {"memory_model", h.memoryModel},
      {"parameters", h.parameters},
      {"first_stamp", exact(h.firstStamp)}};
  for (const auto& [name, value] : rows) {
    const std::string key = name;
    insert.bind(1, key).bind(2, value).bind(3, std::uint64_t{crc32Of(key + '\n' + value)}).run();
  }
}

void writeState(Database& database, const MapState& state) {
  const Blob row = encode(state);
  Statement(database, "INSERT OR REPLACE INTO state VALUES (0, ?)").bind(1, row).run();
}

/// Deletes the rows of what the map has no more.
void remove(Database& database, const map::MapChanges& changes) {
  const auto from = [&](const char* table, const auto& ids) {
    if (ids.empty()) return;
    Statement gone(database, ("DELETE FROM " + std::string(table) + " WHERE id = ?").c_str());
    for (const auto id : ids) gone.bind(1, std::uint64_t{id.value}).run();
  };
  from("places", changes.removedPlaces);
  from("memories", changes.removedPlaces);
  from("views", changes.removedViews);
  from("edges", changes.removedEdges);
}

void requireMap(Database& database) {
  if (database.number("PRAGMA application_id") != kApplicationId)
    throw base::Error("map '" + database.path() + "': it is not an Engram map");
  const auto version = database.number("PRAGMA user_version");
  if (version > kFormatVersion)
    throw base::Error("map '" + database.path() + "' has format " + std::to_string(version) +
                      "; this program reads up to " + std::to_string(kFormatVersion) +
                      ". Use a newer Engram");
  if (version < 1) throw base::Error("map '" + database.path() + "' is damaged: it has no format version");
}

}  // namespace

struct MapFile::Impl {
  Impl(const std::string& path, Database::Mode mode)
      : database(std::make_unique<Database>(path, mode)),
        name(path),
        writable(mode != Database::Mode::kReadOnly) {}

  Database& open() const {
    if (!database) throw base::Error("map '" + name + "' is closed");
    return *database;
  }

  std::unique_ptr<Database> database;
  std::string name;
  bool writable;
  map::MapHeader header;
  MapState state;
};

MapFile::MapFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MapFile::MapFile(MapFile&&) noexcept = default;
MapFile& MapFile::operator=(MapFile&&) noexcept = default;

MapFile::~MapFile() {
  try {
    if (impl_) close();
  } catch (const base::Error&) {
    // The log stays beside the file; the next writer folds it in.
  }
}

MapFile MapFile::create(const std::string& path, const map::MapHeader& header, bool overwrite) {
  if (path.empty()) throw base::Error("the map needs a file name");
  if (fs::exists(path)) removeOld(path, overwrite);
  const fs::path folder = fs::absolute(path).parent_path();
  if (!fs::is_directory(folder))
    throw base::Error("cannot create map '" + path + "': folder '" + folder.string() + "' does not exist");
  auto impl = std::make_unique<Impl>(path, Database::Mode::kCreate);
  Transaction transaction(*impl->database);
  impl->database->execute(kSchema);
  writeHeader(*impl->database, header);
  writeState(*impl->database, impl->state);
  transaction.commit();
  impl->header = header;
  return MapFile(std::move(impl));
}

MapFile MapFile::open(const std::string& path, Access access) {
  if (!fs::exists(path)) throw base::Error("map '" + path + "' does not exist");
  if (!fs::is_regular_file(path)) throw base::Error("map '" + path + "' is not a file");
  if (fs::file_size(path) == 0) throw base::Error("map '" + path + "' is empty");
  const bool write = access == Access::kReadWrite;
  // Looked at before it is opened for writing: a file that is not ours is not touched.
  if (write) {
    Database look(path, Database::Mode::kReadOnly);
    requireMap(look);
  }
  auto impl = std::make_unique<Impl>(path, write ? Database::Mode::kReadWrite : Database::Mode::kReadOnly);
  requireMap(*impl->database);
  MapReader reader(*impl->database);
  impl->header = reader.header();
  impl->state = reader.state();
  return MapFile(std::move(impl));
}

const std::string& MapFile::path() const { return impl_->name; }
const map::MapHeader& MapFile::header() const { return impl_->header; }

map::TopologicalMap MapFile::load() const { return map::TopologicalMap(MapReader(impl_->open()).content()); }

void MapFile::commit(const map::TopologicalMap& map, const map::MapChanges& changes,
                     const types::FrameReport* report) {
  if (!impl_->writable) throw base::Error("map '" + impl_->name + "' was opened for reading only");
  Database& database = impl_->open();
  const map::MapContent& content = map.content();
  Transaction transaction(database);
  if (MapReader(database).state().commits != impl_->state.commits)
    throw base::Error("map '" + impl_->name +
                      "': another program has changed it meanwhile. Only one may write a map");

  const auto put = [&](Statement& insert, std::uint64_t id, const Blob& row) {
    insert.bind(1, id).bind(2, row).run();
  };
  Statement place(database, "INSERT OR REPLACE INTO places VALUES (?, ?)");
  for (const auto id : changes.places) put(place, id.value, encode(map.place(id)));
  Statement memory(database, "INSERT OR REPLACE INTO memories VALUES (?, ?)");
  for (const auto id : changes.memories) put(memory, id.value, encodeMemory(id, map.place(id).memory));
  Statement view(database, "INSERT OR REPLACE INTO views VALUES (?, ?)");
  for (const auto id : changes.views) put(view, id.value, encode(content.views.at(id)));
  Statement edge(database, "INSERT OR REPLACE INTO edges VALUES (?, ?)");
  for (const auto id : changes.edges) put(edge, id.value, encode(map.edge(id)));
  remove(database, changes);
  if (changes.pathForgotten) database.execute("DELETE FROM path");
  Statement moved(database, "UPDATE path SET data = ?2 WHERE id = ?1");
  for (const std::size_t i : changes.movedPathPoints) put(moved, i, encode(content.path[i], i));
  Statement point(database, "INSERT INTO path VALUES (?, ?)");
  for (std::size_t i = changes.firstNewPathPoint; i < changes.pathSize; ++i)
    put(point, i, encode(content.path[i], i));

  MapState next = impl_->state;
  if (report != nullptr) {
    const std::string json = toJson(*report);
    Statement record(database, "INSERT INTO records VALUES (?, ?, ?)");
    record.bind(1, next.records++).bind(2, json).bind(3, std::uint64_t{crc32Of(json)}).run();
  }
  ++next.commits;
  next.nextPlace = content.nextPlace;
  next.nextView = content.nextView;
  next.nextEdge = content.nextEdge;
  next.places = content.places.size();
  next.views = content.views.size();
  next.edges = content.edges.size();
  next.path = content.path.size();
  next.redetections = content.redetections;
  writeState(database, next);
  transaction.commit();
  impl_->state = next;
}

void MapFile::forgetRecords(double before) {
  if (!impl_->writable) throw base::Error("map '" + impl_->name + "' was opened for reading only");
  Database& database = impl_->open();
  Transaction transaction(database);
  const std::string text = exact(before);
  database.execute(("DELETE FROM records WHERE json_extract(json, '$.stamp') < " + text).c_str());
  const auto left = static_cast<std::uint64_t>(database.number("SELECT COUNT(*) FROM records"));
  MapState next = impl_->state;
  if (left == next.records) return;
  database.execute(("UPDATE records SET id = id - " + std::to_string(next.records - left)).c_str());
  next.records = left;
  ++next.commits;
  writeState(database, next);
  transaction.commit();
  impl_->state = next;
}

std::vector<types::FrameReport> MapFile::records() const { return MapReader(impl_->open()).records(); }

std::vector<std::string> MapFile::check() const {
  std::vector<std::string> problems;
  try {
    Statement integrity(impl_->open(), "PRAGMA integrity_check");
    while (integrity.step())
      if (integrity.text(0) != "ok") problems.push_back(integrity.text(0));
    MapReader reader(impl_->open(), &problems);
    reader.content();
    reader.records();
  } catch (const base::Error& e) {
    problems.emplace_back(e.what());
  }
  return problems;
}

void MapFile::dump(std::ostream& out) const {
  MapReader reader(impl_->open());
  store::dump(out, impl_->header, reader.content(), reader.records());
}

std::uint64_t MapFile::bytes() const {
  std::uint64_t sum = 0;
  for (const char* suffix : {"", "-wal"}) {
    std::error_code error;
    const auto size = fs::file_size(impl_->name + suffix, error);
    if (!error) sum += size;
  }
  return sum;
}

void MapFile::close() {
  if (!impl_->database) return;
  const std::unique_ptr<Database> database = std::move(impl_->database);
  if (impl_->writable) database->foldLog();
}

}  // namespace engram::store
