// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// A whole map file. Bytes that begin with SQLite's name are the file; all others are a list of changes to a
// small sound map: table, id, length (one byte each) and the content of the row, whose checksum is made right
// here.
#include "blob.h"
#include "engram/base/error.h"
#include "engram/store/map_file.h"

#include <sqlite3.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;
using namespace engram;

/// A folder for this process, gone with it.
struct Folder {
  Folder() {
    const char* memory = "/dev/shm";
    std::string name =
        (fs::is_directory(memory) ? memory : fs::temp_directory_path().string()) + "/engram_fuzz_XXXXXX";
    path = mkdtemp(name.data());
  }
  ~Folder() { fs::remove_all(path); }
  std::string path;
};

std::string bytesOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Two places, an edge, a view, a point of the path and a record.
std::string soundMap(const std::string& path) {
  map::TopologicalMap map;
  for (int i = 0; i < 2; ++i) {
    map::Place place;
    place.memory.edit().features.keypoints.resize(1);
    place.memory.edit().features.descriptors = types::Descriptors(types::DescriptorKind::kInt8, 8);
    place.memory.edit().features.descriptors.resize(1);
    place.memory.edit().states.emplace_back().history = {200};
    place.memory.edit().nextFeatureId = 1;
    map.addPathPoint({.anchor = map.addPlace(place)});
  }
  map.addView({.place = map::PlaceId(0)});
  map.addEdge({.a = map::PlaceId(0), .b = map::PlaceId(1)});
  map::MapHeader header;
  header.descriptorDim = 8;
  const types::FrameReport report;
  store::MapFile::create(path, header, true).commit(map, map.takeChanges(), &report);
  return bytesOf(path);
}

void changeRow(sqlite3* db, std::uint8_t table, std::uint8_t id, std::span<const std::uint8_t> content) {
  static constexpr const char* kTables[] = {"state", "places", "memories", "views", "edges", "path"};
  static constexpr store::RowKind kKinds[] = {store::RowKind::kState,  store::RowKind::kPlace,
                                              store::RowKind::kMemory, store::RowKind::kView,
                                              store::RowKind::kEdge,   store::RowKind::kPath};
  const std::size_t n = table % std::size(kTables);
  store::BlobWriter writer(kKinds[n], 1 + (table >> 7));
  writer.raw(content.data(), content.size());
  if (kKinds[n] == store::RowKind::kMemory) writer.compress();
  const store::Blob row = std::move(writer).seal(id);
  sqlite3_stmt* put = nullptr;
  const std::string sql = std::string("INSERT OR REPLACE INTO ") + kTables[n] + " VALUES (?, ?)";
  sqlite3_prepare_v2(db, sql.c_str(), -1, &put, nullptr);
  sqlite3_bind_int(put, 1, id);
  sqlite3_bind_blob64(put, 2, row.data(), row.size(), SQLITE_STATIC);
  sqlite3_step(put);
  sqlite3_finalize(put);
}

void change(const std::string& path, std::span<const std::uint8_t> bytes) {
  sqlite3* db = nullptr;
  sqlite3_open(path.c_str(), &db);
  sqlite3_exec(db, "PRAGMA synchronous = OFF; PRAGMA journal_mode = MEMORY; BEGIN", nullptr, nullptr,
               nullptr);
  while (bytes.size() >= 3) {
    const std::size_t size = std::min<std::size_t>(bytes[2], bytes.size() - 3);
    changeRow(db, bytes[0], bytes[1], bytes.subspan(3, size));
    bytes = bytes.subspan(3 + size);
  }
  sqlite3_exec(db, "COMMIT", nullptr, nullptr, nullptr);
  sqlite3_close(db);
}

void write(const std::string& path, const void* data, std::size_t size) {
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  const std::string path = folder.path + "/m.engram";
  static const std::string sound = soundMap(path);
  for (const char* left : {"-wal", "-shm", "-journal"}) fs::remove(path + left);
  if (size >= 6 && std::string_view(reinterpret_cast<const char*>(data), 6) == "SQLite") {
    write(path, data, size);
  } else {
    write(path, sound.data(), sound.size());
    change(path, {data, size});
  }
  try {
    const store::MapFile file = store::MapFile::open(path, store::Access::kReadOnly);
    const bool isSound = file.check().empty();
    try {
      std::ostringstream out;
      file.load();
      file.dump(out);
    } catch (const base::Error&) {
      if (isSound) std::abort();  // check() had nothing to say
    }
  } catch (const base::Error&) {
    // Refused: what it is for.
  }
  return 0;
}
