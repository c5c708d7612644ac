// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/store/map_file.h"

#include "database.h"
#include "derived_rows.h"
#include "diagnosis.h"
#include "engram/base/error.h"
#include "engram/store/report_json.h"
#include "feature_counts.h"
#include "map_reader.h"
#include "rows.h"
#include "rows_on_demand.h"
#include "schema.h"
#include "server.h"
#include "undo.h"
#include "whole_rows.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <stdexcept>

namespace engram::store {
namespace {

namespace fs = std::filesystem;

void removeOld(const std::string& path, bool overwrite) {
  if (!overwrite)
    throw base::Error("map '" + path + "' exists already. Extend it, overwrite it, or choose another name");
  if (!fs::is_regular_file(path) || !looksLikeMap(path))
    throw base::Error("'" + path + "' exists and is not an Engram map: it is not overwritten");
  std::error_code error;
  for (const char* suffix : {"-wal", "-shm", "-journal", ""})
    if (!fs::remove(path + suffix, error) && error)
      throw base::Error("cannot overwrite map '" + path + "': " + error.message());
}

/// What the totals of a map say after this content was written.
MapState stateOf(const map::MapContent& content, const MapState& before) {
  MapState next = before;
  next.nextPlace = content.nextPlace;
  next.nextView = content.nextView;
  next.nextEdge = content.nextEdge;
  next.places = content.places.size();
  next.views = content.views.size();
  next.edges = content.edges.size();
  next.path = content.path.size();
  next.redetections = content.redetections;
  return next;
}

/// Writes and deletes rows, and keeps what they were for Undo.
class RowWriter {
 public:
  RowWriter(Connection& database, Undo& undo, const RowTable& table)
      : database_(database),
        undo_(undo),
        table_(table),
        put_(database, ("INSERT INTO " + std::string(table.name) +
                        " VALUES ($1, $2) ON CONFLICT (id) DO UPDATE SET data = excluded.data")
                           .c_str()) {}

  void put(std::uint64_t id, const Blob& row) {
    undo_.keep(database_, table_, id);
    put_.bind(1, id).bind(2, row).run();
  }
  template <class Ids>
  void remove(const Ids& ids) {
    if (ids.empty()) return;
    Statement gone(database_, ("DELETE FROM " + std::string(table_.name) + " WHERE id = $1").c_str());
    for (const auto id : ids) {
      undo_.keep(database_, table_, id.value);
      gone.bind(1, std::uint64_t{id.value}).run();
    }
  }
  void removeAll() {
    undo_.keepAll(database_, table_);
    database_.execute(("DELETE FROM " + std::string(table_.name)).c_str());
  }

 private:
  Connection& database_;
  Undo& undo_;
  RowTable table_;
  Statement put_;
};

void writeRows(Connection& database, Undo& undo, const map::TopologicalMap& map,
               const map::MapChanges& changes) {
  const map::MapContent& content = map.content();
  RowWriter places(database, undo, kPlaceRows), memories(database, undo, kMemoryRows),
      views(database, undo, kViewRows), edges(database, undo, kEdgeRows), path(database, undo, kPathRows);
  for (const auto id : changes.places) places.put(id.value, encode(map.place(id)));
  for (const auto id : changes.memories) memories.put(id.value, encodeMemory(id, map.place(id).memory));
  for (const auto id : changes.views) views.put(id.value, encode(content.views.at(id)));
  for (const auto id : changes.edges) edges.put(id.value, encode(map.edge(id)));
  places.remove(changes.removedPlaces);
  memories.remove(changes.removedPlaces);
  views.remove(changes.removedViews);
  edges.remove(changes.removedEdges);
  if (changes.pathForgotten) path.removeAll();
  for (const std::size_t i : changes.movedPathPoints) path.put(i, encode(content.path[i], i));
  for (std::size_t i = changes.firstNewPathPoint; i < changes.pathSize; ++i)
    path.put(i, encode(content.path[i], i));
}

void requireCreatable(const std::string& path) {
  if (path.empty()) throw base::Error("the map needs a file name");
  const std::string folder = fs::absolute(path).parent_path().string();
  if (!fs::is_directory(folder))
    throw base::Error("cannot create map '" + path + "': folder '" + folder + "' does not exist");
}

void requireFile(const std::string& path) {
  if (!fs::exists(path)) throw base::Error("map '" + path + "' does not exist");
  if (!fs::is_regular_file(path)) throw base::Error("map '" + path + "' is not a file");
  if (fs::file_size(path) == 0)
    throw base::Error("map '" + path +
                      "' is empty: its writer was cut off at once, or it was copied without its log '" +
                      path + "-wal'");
}

}  // namespace

struct MapFile::Impl {
  Impl(std::shared_ptr<Connection> connection, bool mayWrite)
      : database(std::move(connection)), name(database->path()), writable(mayWrite) {}

  Connection& open() const {
    if (!database) throw base::Error("map '" + name + "' is closed");
    return *database;
  }
  /// Fills a new map, which holds nothing yet.
  void make(const map::MapHeader& made);
  /// Reads what the map says of itself.
  void look();
  /// The first call makes the file ready to be written.
  Connection& openForWriting();
  Drive& currentDrive() {
    if (!drive) throw std::logic_error("MapFile: no drive was begun");
    return *drive;
  }

  std::optional<WriterLock> lock;
  std::shared_ptr<Connection> database;  // after the lock: closed before that is given back
  std::shared_ptr<RowsOnDemand> rows;    // of the map that was loaded on demand
  std::string name;
  bool writable;
  bool ready = false;  ///< for writing
  std::uint64_t closedBytes = 0;
  int version = kFormatVersion;
  map::MapHeader header;
  MapState state;
  std::optional<Drive> drive;  ///< under way
  Undo undo;
};

/// One transaction. What it wrote counts only after commit().
class MapFile::Edit {
 public:
  explicit Edit(Impl& impl)
      : impl_(impl), transaction_(impl.openForWriting()), next(impl.state), drive(impl.drive) {
    if (MapReader(database()).state().commits != impl.state.commits)
      throw base::Error("map '" + impl.name +
                        "': another program has changed it meanwhile. Only one may write a map");
    ++next.commits;
  }
  ~Edit() { impl_.undo.settle(committed_); }
  Edit(const Edit&) = delete;
  Edit& operator=(const Edit&) = delete;

  Connection& database() { return *impl_.database; }
  void commit() {
    writeState(database(), next);
    if (drive) writeDrive(database(), *drive);
    transaction_.commit();
    impl_.state = next;
    impl_.drive = drive;
    committed_ = true;
  }

 private:
  Impl& impl_;
  Transaction transaction_;
  bool committed_ = false;

 public:
  MapState next;               ///< of the map after this
  std::optional<Drive> drive;  ///< under way after this
};

Connection& MapFile::Impl::openForWriting() {
  if (!writable) throw base::Error("map '" + name + "' was opened for reading only");
  Connection& opened = open();
  if (ready) return opened;
  opened.beginWriting();
  if (version < kFormatVersion) {
    Transaction transaction(opened);
    opened.upgrade(version);
    transaction.commit();
    version = kFormatVersion;
  }
  ready = true;
  return opened;
}

void MapFile::Impl::make(const map::MapHeader& made) {
  Transaction transaction(*database);
  database->makeTables();
  writeHeader(*database, made);
  writeState(*database, state);
  transaction.commit();
  openForWriting();
  header = made;
}

void MapFile::Impl::look() {
  if (!writable) database->beginSnapshot();
  version = database->formatVersion();
  MapReader reader(*database);
  header = reader.header();
  state = reader.state();
  if (writable) reader.requireLastRecord(state);
}

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
  if (isOnServer(path)) {
    const ServerMode mode = overwrite ? ServerMode::kReplace : ServerMode::kCreate;
    auto impl = std::make_unique<Impl>(connectToServer(path, mode), true);
    impl->make(header);
    return MapFile(std::move(impl));
  }
  requireCreatable(path);
  return create(WriterLock(path), header, overwrite);
}

MapFile MapFile::create(WriterLock lock, const map::MapHeader& header, bool overwrite) {
  const std::string path = lock.mapPath();
  requireCreatable(path);
  if (fs::exists(path)) removeOld(path, overwrite);
  auto impl = std::make_unique<Impl>(std::make_unique<Database>(path, Database::Mode::kCreate), true);
  impl->lock = std::move(lock);
  // Without the log yet: a map that was cut off while it was made is an empty file, or whole.
  impl->make(header);
  return MapFile(std::move(impl));
}

MapFile MapFile::open(const std::string& path, Access access) {
  const bool write = access == Access::kReadWrite;
  if (isOnServer(path)) {
    const ServerMode mode = write ? ServerMode::kReadWrite : ServerMode::kReadOnly;
    auto impl = std::make_unique<Impl>(connectToServer(path, mode), write);
    impl->look();
    return MapFile(std::move(impl));
  }
  requireFile(path);
  std::optional<WriterLock> lock;
  if (write) {
    // Looked at before it is opened for writing: a file that is not ours is not touched.
    Database look(path, Database::Mode::kReadOnly);
    requireMap(look);
    lock.emplace(path);
  }
  auto impl = std::make_unique<Impl>(
      std::make_unique<Database>(path, write ? Database::Mode::kReadWrite : Database::Mode::kReadOnly),
      write);
  impl->lock = std::move(lock);
  impl->look();
  return MapFile(std::move(impl));
}

const std::string& MapFile::path() const { return impl_->name; }
const map::MapHeader& MapFile::header() const { return impl_->header; }

map::TopologicalMap MapFile::load() const { return map::TopologicalMap(MapReader(impl_->open()).content()); }

map::TopologicalMap MapFile::loadOnDemand() {
  impl_->open();
  // What has lost its log is nobody's snapshot.
  if (!impl_->writable && !isOnServer(impl_->name) && logIsMissing(impl_->name)) return load();
  impl_->rows = std::make_shared<RowsOnDemand>(impl_->database, impl_->header, impl_->version);
  map::MapContent content = MapReader(impl_->open()).content(impl_->rows);
  content.derived = impl_->rows;
  return map::TopologicalMap(std::move(content));
}

map::TopologicalMap MapFile::loadGraph() {
  impl_->rows = std::make_shared<RowsOnDemand>(impl_->database, impl_->header, impl_->version);
  return map::TopologicalMap(MapReader(impl_->open()).content(impl_->rows, false));
}

void MapFile::yieldToWriter() {
  if (!impl_->database || impl_->writable || !impl_->rows || isOnServer(impl_->name) ||
      !WriterLock::isHeld(impl_->name))
    return;
  impl_->rows->letGo();
  impl_->database.reset();
}

void MapFile::keep(std::span<const map::DerivedRow> rows) {
  const CountsByPlace counts = countFeatures(impl_->open(), impl_->version);
  if (rows.empty() && impl_->version >= 3 && counts == keptCounts(impl_->open())) return;
  Edit edit(*impl_);
  writeDerived(edit.database(), rows);
  writeCounts(edit.database(), counts);
  edit.commit();
}

void MapFile::commit(const map::TopologicalMap& map, const map::MapChanges& changes,
                     const types::FrameReport* report) {
  commit(map, changes, std::span(report, report == nullptr ? 0 : 1));
}

void MapFile::commit(const map::TopologicalMap& map, const map::MapChanges& changes,
                     std::span<const types::FrameReport> reports) {
  Edit edit(*impl_);
  writeRows(edit.database(), impl_->undo, map, changes);
  for (const types::FrameReport& report : reports) {
    writeRecord(edit.database(), edit.next.nextRecord(), toJson(report));
    ++edit.next.records;
    if (!edit.drive) continue;
    ++edit.drive->images;
    edit.drive->lastStamp = report.stamp;
  }
  edit.next = stateOf(map.content(), edit.next);
  edit.commit();
}

std::vector<Drive> MapFile::drives() const {
  return impl_->version < 2 ? std::vector<Drive>{} : MapReader(impl_->open()).drives();
}

void MapFile::beginDrive(Drive drive) {
  Edit edit(*impl_);
  drive.id = static_cast<std::uint32_t>(drives().size());
  drive.firstRecord = edit.next.nextRecord();
  drive.images = 0;
  drive.finished = false;
  edit.drive = drive;
  impl_->undo.begin(edit.database(), edit.next);
  edit.commit();
}

void MapFile::endDrive() {
  impl_->currentDrive();
  {
    Edit edit(*impl_);
    edit.drive->finished = true;
    impl_->undo.clear(edit.database());
    edit.commit();
  }
  impl_->drive.reset();
  impl_->open().giveBackSpace();
}

map::TopologicalMap MapFile::loadBeforeLastDrive() {
  Connection& database = impl_->openForWriting();
  Transaction rolledBack(database);
  MapState base = Undo::takeBack(database);
  base.firstRecord = impl_->state.firstRecord;
  base.records = impl_->state.records;
  writeState(database, base);
  return map::TopologicalMap(MapReader(database).content());
}

void MapFile::resumeDrive(const map::TopologicalMap& map, const map::MapChanges& changes) {
  Edit edit(*impl_);
  Undo::takeBack(edit.database());
  impl_->undo.load(edit.database());
  edit.drive = drives().back();
  writeRows(edit.database(), impl_->undo, map, changes);
  edit.next = stateOf(map.content(), edit.next);
  edit.commit();
}

void MapFile::forgetRecords(int firstKeptSession) {
  const std::vector<Drive> all = drives();
  const auto kept = std::find_if(all.begin(), all.end(),
                                 [&](const Drive& drive) { return drive.session >= firstKeptSession; });
  if (kept == all.end() || kept->firstRecord <= impl_->state.firstRecord) return;
  Edit edit(*impl_);
  Statement(edit.database(), "DELETE FROM records WHERE id < $1").bind(1, kept->firstRecord).run();
  edit.next.records = edit.next.nextRecord() - kept->firstRecord;
  edit.next.firstRecord = kept->firstRecord;
  edit.commit();
}

FeatureCounts MapFile::featureCounts() const { return sumOf(countFeatures(impl_->open(), impl_->version)); }

std::uint64_t MapFile::recordCount() const { return impl_->state.records; }
std::uint64_t MapFile::viewCount() const { return impl_->state.views; }

std::map<std::string, std::string> MapFile::notes() const { return readNotes(impl_->open()); }

WholeMap MapFile::whole() const {
  Connection& database = impl_->open();
  MapReader reader(database);
  return {
      impl_->header,    reader.content(),         impl_->version < 2 ? drivesFromRecords(database) : drives(),
      reader.records(), impl_->state.firstRecord, readNotes(impl_->open())};
}

void MapFile::replace(const WholeMap& whole) {
  std::vector<std::string> broken = map::brokenRules(whole.content);
  if (broken.empty()) broken = map::brokenRules(whole.header, whole.content);
  if (!broken.empty())
    throw base::Error("map '" + impl_->name + "': it would not be sound: " + broken.front());
  Edit edit(*impl_);
  writeWhole(edit.database(), whole);
  const MapState before = edit.next;
  edit.next = stateOf(whole.content, before);
  edit.next.nextPlace = std::max(before.nextPlace, edit.next.nextPlace);
  edit.next.nextView = std::max(before.nextView, edit.next.nextView);
  edit.next.nextEdge = std::max(before.nextEdge, edit.next.nextEdge);
  edit.next.records = whole.records.size();
  edit.next.firstRecord = whole.firstRecord;
  edit.drive.reset();
  edit.commit();
  impl_->undo = {};
  impl_->header = whole.header;
  impl_->open().giveBackSpace();
}

std::vector<types::FrameReport> MapFile::records() const { return MapReader(impl_->open()).records(); }

std::vector<std::string> MapFile::check() const {
  std::vector<std::string> problems;
  try {
    problems = impl_->open().integrity();
    MapReader reader(impl_->open(), &problems);
    reader.content();
    reader.records();
    if (impl_->version >= 2) reader.drives();
    if (impl_->version >= 3) checkDerived(impl_->open(), problems);
  } catch (const base::Error& e) {
    problems.emplace_back(e.what());
  }
  return problems;
}

void MapFile::dump(std::ostream& out) const {
  MapReader reader(impl_->open());
  store::dump(out, impl_->header, reader.content(), reader.records(), drives());
}

std::uint64_t MapFile::bytes() const {
  return impl_->database ? impl_->database->bytes() : impl_->closedBytes;
}

bool MapFile::exists(const std::string& path) {
  std::error_code none;
  return isOnServer(path) ? existsOnServer(path) : fs::exists(path, none);
}

void MapFile::close() {
  if (!impl_->database) return;
  {
    const std::shared_ptr<Connection> database = std::move(impl_->database);
    const bool stillRead = impl_->rows && !impl_->writable;  // its memories, by the map that was loaded
    if (impl_->rows && impl_->writable) impl_->rows->closing(impl_->state.commits);
    if (!stillRead) database->finish(impl_->ready);
    impl_->closedBytes = database->bytes();
  }
  impl_->lock.reset();
}

}  // namespace engram::store
