// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "database.h"
#include "diagnosis.h"
#include "engram/base/error.h"
#include "engram/store/map_copy.h"
#include "engram/store/map_file.h"
#include "engram/store/writer_lock.h"
#include "rows.h"
#include "salvage.h"
#include "schema.h"
#include "scratch.h"
#include "server.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>

namespace engram::store {
namespace {

namespace fs = std::filesystem;

/// "3, 7, 9 and others"
std::string listed(const std::set<std::uint64_t>& numbers, std::uint64_t count) {
  constexpr std::size_t kShown = 10;
  std::string out;
  std::size_t shown = 0;
  for (const std::uint64_t number : numbers) {
    if (shown == kShown) break;
    out += (shown++ == 0 ? "" : ", ") + std::to_string(number);
  }
  return out.empty() || count <= shown ? out : out + " and others";
}

/// What of a kind is not in the new map. `expected` says how many there were, if that is known.
void noteLoss(Recovery& recovery, const std::string& kind, std::optional<std::uint64_t> expected,
              std::uint64_t kept, const std::set<std::uint64_t>& numbers) {
  if (expected ? *expected <= kept : numbers.empty()) return;
  const std::uint64_t lost = expected ? *expected - kept : numbers.size();
  const std::string which = listed(numbers, lost);
  recovery.lost.push_back((expected ? std::to_string(lost) + " of " + std::to_string(*expected)
                                    : "at least " + std::to_string(lost)) +
                          " " + kind + (which.empty() ? "" : ": number " + which));
}

/// Makes a sound map of what was read.
class Builder {
 public:
  explicit Builder(Salvage& from) : from_(from), content_(from.content) {}

  void build() {
    dropBadPlaces();
    dropBadViews();
    dropBadEdges();
    joinPath();
    numberRecords();
    total();
  }
  Recovery report() const;
  void write(Database& database) const;

 private:
  std::set<std::uint64_t>& bad(const char* kind) { return from_.bad[kind]; }
  bool isPlace(map::PlaceId id) const { return content_.places.contains(id); }

  /// A place whose memory is lost stays: its pose holds the graph and the path together.
  void dropBadPlaces() {
    const types::Descriptors none(from_.header.descriptorKind, from_.header.descriptorDim);
    for (auto& [id, place] : content_.places) {
      const types::Descriptors& kept = place.memory->features.descriptors;
      const bool fits = kept.kind() == none.kind() && kept.dim() == none.dim();
      if (fits && from_.memories.contains(id.value)) continue;
      bad("memory").insert(id.value);
      place.memory = {};
      place.memory.edit().features.descriptors = none;
    }
    std::erase_if(content_.places, [&](const auto& item) {
      if (map::brokenRule(item.second).empty()) return false;
      return bad("place").insert(item.first.value), true;
    });
  }
  void dropBadViews() {
    std::erase_if(content_.views, [&](const auto& item) {
      if (isPlace(item.second.place)) return false;
      return bad("view").insert(item.first.value), true;
    });
  }
  void dropBadEdges() {
    std::erase_if(content_.edges, [&](const auto& item) {
      const map::Edge& edge = item.second;
      if (isPlace(edge.a) && isPlace(edge.b) && map::brokenRule(edge).empty()) return false;
      return bad("edge").insert(item.first.value), true;
    });
    for (auto& [id, edge] : content_.edges)
      if (!from_.memories.contains(edge.a.value) || !from_.memories.contains(edge.b.value))
        edge.correspondences.clear();
  }
  void joinPath() {
    for (const auto& [i, point] : from_.path)
      if (isPlace(point.anchor)) content_.path.push_back(point);
  }
  void numberRecords();
  void total();

  Salvage& from_;
  map::MapContent& content_;
  MapState state_;
  std::vector<Drive> drives_;
  std::vector<std::string> records_;
};

/// Numbers of records follow each other, so those after a lost one move up, and the drives with them.
void Builder::numberRecords() {
  const std::uint64_t first = from_.state ? from_.state->firstRecord : 0;
  for (const auto& [id, json] : from_.records)
    if (id >= first) records_.push_back(json);
  const auto keptBefore = [&](std::uint64_t id) {
    return static_cast<std::uint64_t>(
        std::distance(from_.records.lower_bound(first), from_.records.lower_bound(std::max(id, first))));
  };
  for (const auto& [id, known] : from_.drives) {
    Drive drive = known;
    drive.id = static_cast<std::uint32_t>(drives_.size());
    if (known.firstRecord >= first) {
      drive.firstRecord = first + keptBefore(known.firstRecord);
      drive.images = keptBefore(known.firstRecord + known.images) - keptBefore(known.firstRecord);
    }
    drives_.push_back(drive);
  }
}

void Builder::total() {
  if (from_.state) state_ = *from_.state;
  const auto next = [](std::uint32_t known, const auto& items) {
    return items.empty() ? known : std::max(known, items.rbegin()->first.value + 1);
  };
  content_.nextPlace = state_.nextPlace = next(state_.nextPlace, content_.places);
  content_.nextView = state_.nextView = next(state_.nextView, content_.views);
  content_.nextEdge = state_.nextEdge = next(state_.nextEdge, content_.edges);
  content_.redetections = state_.redetections;
  state_.places = content_.places.size();
  state_.views = content_.views.size();
  state_.edges = content_.edges.size();
  state_.path = content_.path.size();
  state_.records = records_.size();
}

Recovery Builder::report() const {
  Recovery r{state_.places, state_.views, state_.edges, state_.path, state_.records, {}};
  const auto known = [&](std::uint64_t MapState::*count) {
    return from_.state ? std::optional((*from_.state).*count) : std::nullopt;
  };
  const auto numbers = [&](const char* kind) {
    const auto it = from_.bad.find(kind);
    return it == from_.bad.end() ? std::set<std::uint64_t>{} : it->second;
  };
  if (!from_.state) r.lost.push_back("the row of totals: more may be lost than is known");
  for (const std::string& key : from_.lostHeaders) r.lost.push_back("the entry '" + key + "' of the header");
  noteLoss(r, "places", known(&MapState::places), r.places, numbers("place"));
  const auto remembered = static_cast<std::uint64_t>(
      std::count_if(content_.places.begin(), content_.places.end(),
                    [&](const auto& item) { return from_.memories.contains(item.first.value); }));
  noteLoss(r, "memories of places that are kept", r.places, remembered, numbers("memory"));
  noteLoss(r, "views", known(&MapState::views), r.views, numbers("view"));
  noteLoss(r, "edges", known(&MapState::edges), r.edges, numbers("edge"));
  noteLoss(r, "path points", known(&MapState::path), r.path, numbers("path point"));
  noteLoss(r, "records", known(&MapState::records), r.records, numbers("record"));
  noteLoss(r, "drives", std::nullopt, drives_.size(), numbers("drive"));
  return r;
}

template <class Items, class Encode>
void insertAll(Database& database, const std::string& table, const Items& items, Encode&& encoded) {
  Statement insert(database, ("INSERT INTO " + table + " VALUES (?, ?)").c_str());
  for (const auto& [id, item] : items) {
    const Blob row = encoded(item);
    insert.bind(1, std::uint64_t{id.value}).bind(2, row).run();
  }
}

void Builder::write(Database& database) const {
  database.beginWriting();
  Transaction transaction(database);
  createSchema(database);
  writeHeader(database, from_.header);
  writeState(database, state_);
  insertAll(database, "places", content_.places, [](const map::Place& p) { return encode(p); });
  insertAll(database, "memories", content_.places,
            [](const map::Place& p) { return encodeMemory(p.id, p.memory); });
  insertAll(database, "views", content_.views, [](const map::View& v) { return encode(v); });
  insertAll(database, "edges", content_.edges, [](const map::Edge& e) { return encode(e); });
  Statement path(database, "INSERT INTO path VALUES (?, ?)");
  for (std::size_t i = 0; i < content_.path.size(); ++i) {
    const Blob row = encode(content_.path[i], i);
    path.bind(1, std::uint64_t{i}).bind(2, row).run();
  }
  for (std::size_t i = 0; i < records_.size(); ++i)
    writeRecord(database, state_.firstRecord + i, records_[i]);
  for (const Drive& drive : drives_) writeDrive(database, drive);
  if (drives_.empty())
    for (Drive drive : drivesFromRecords(database)) {
      drive.firstRecord += state_.firstRecord;
      writeDrive(database, drive);
    }
  transaction.commit();
}

/// The first page of a file tells where its tables are. Where it is damaged, that of a new map is tried:
/// tables are always made in the same order.
void replaceFirstPage(const std::string& damaged, const std::string& scratch, bool ofVersion1) {
  const std::string fresh = scratch + "-fresh";
  fs::remove(fresh);
  {
    Database database(fresh, Database::Mode::kCreate);
    if (ofVersion1) database.execute("PRAGMA auto_vacuum = NONE");
    Transaction transaction(database);
    createSchema(database);
    transaction.commit();
  }
  std::string page(4096, '\0');
  std::ifstream(fresh, std::ios::binary).read(page.data(), static_cast<std::streamsize>(page.size()));
  const auto pages = static_cast<std::uint32_t>(fs::file_size(damaged) / page.size());
  for (int i = 0; i < 4; ++i)
    page[28 + static_cast<std::size_t>(i)] = static_cast<char>(pages >> (24 - 8 * i));
  std::fill_n(page.begin() + 32, 8, '\0');  // no free pages
  std::fstream(damaged, std::ios::binary | std::ios::in | std::ios::out)
      .write(page.data(), static_cast<std::streamsize>(page.size()));
}

std::optional<Salvage> salvageFile(const std::string& path) {
  try {
    Database database(path, Database::Mode::kDamaged);
    return salvage(database);
  } catch (const base::Error&) {
    return std::nullopt;
  }
}

/// The best of what can be read of a private copy of the map.
Salvage salvageBest(const std::string& from, const std::string& work) {
  copyFiles(from, work);
  std::optional<Salvage> best = salvageFile(work);
  for (const bool ofVersion1 : {false, true}) {
    if (best && best->state && best->rows() > 0) break;
    if (fs::file_size(work) < 8192) break;
    replaceFirstPage(work, work, ofVersion1);
    std::optional<Salvage> other = salvageFile(work);
    if (other && (!best || other->rows() > best->rows())) best = std::move(other);
  }
  if (!best || (best->content.places.empty() && best->records.empty()))
    throw base::Error("map '" + from + "': nothing could be recovered from it");
  return std::move(*best);
}

/// Of a map that is sound; nothing otherwise.
std::optional<Recovery> copyIfSound(const std::string& from, NewMap& target) {
  try {
    {
      const MapFile file = MapFile::open(readablePath(from, target.scratch()), Access::kReadOnly);
      if (!file.check().empty()) return std::nullopt;
    }
    copyContent(readablePath(from, target.scratch()), target.file());
    Database(target.file(), Database::Mode::kReadWrite).foldLog();
  } catch (const base::Error&) {
    fs::remove(target.file());
    return std::nullopt;
  }
  const MapFile copy = MapFile::open(target.file(), Access::kReadOnly);
  const auto content = copy.load();
  Recovery whole{content.places().size(), content.content().views.size(), content.edges().size(),
                 content.path().size(),   copy.records().size(),          {}};
  if (const std::string missing = missingLog(from); !missing.empty()) whole.lost.push_back(missing);
  return whole;
}

Recovery rebuild(const std::string& from, NewMap& target) {
  // Read without its writer's leave, the file and its log would be of two moments.
  std::optional<WriterLock> lock;
  if (fs::exists(realPath(from) + "-lock")) lock.emplace(from);
  Salvage salvaged = salvageBest(from, target.scratch());
  Builder builder(salvaged);
  builder.build();
  {
    Database database(target.file(), Database::Mode::kCreate);
    builder.write(database);
    database.foldLog();
  }
  const auto problems = MapFile::open(target.file(), Access::kReadOnly).check();
  if (!problems.empty())
    throw base::Error("map '" + from + "': what can be read of it makes no map: " + problems.front());
  Recovery recovery = builder.report();
  if (const std::string missing = missingLog(from); !missing.empty()) recovery.lost.push_back(missing);
  if (recovery.lost.empty())
    recovery.lost.emplace_back("nothing that was counted; the structure of the file was damaged");
  return recovery;
}

}  // namespace

Recovery recoverMap(const std::string& from, const std::string& to, bool overwrite) {
  if (isOnServer(from) || isOnServer(to))
    throw base::Error(
        "only a map file can be recovered: a server keeps its rows by itself. To copy one: engram-map copy");
  requireSource(from, to);
  NewMap target(to, overwrite);
  std::optional<Recovery> recovery = copyIfSound(from, target);
  if (!recovery) recovery = rebuild(from, target);
  target.publish();
  return *recovery;
}

}  // namespace engram::store
