// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// One map, a program that writes it and others that read it.
#include "engram/store/map_file.h"
#include "sample_map.h"
#include "store_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <chrono>
#include <thread>

namespace engram::store {
namespace {

using engram::testing::ringMap;
using ::testing::HasSubstr;

using SharingTest = StoreTest;

TEST_F(SharingTest, ReadersAndOneWriterGetAlong) {
  auto map = ringMap(4);
  MapFile writer = MapFile::create(path("a.engram"), sampleHeader());
  writer.commit(map, map.takeChanges());
  const MapFile reader = MapFile::open(path("a.engram"), Access::kReadOnly);
  EXPECT_EQ(reader.load().places().size(), 4u);
  map.addPlace({});
  writer.commit(map, map.takeChanges());
  EXPECT_EQ(reader.load().places().size(), 5u);
  MapFile second = MapFile::open(path("a.engram"), Access::kReadWrite);
  map.addPlace({});
  writer.commit(map, map.takeChanges());
  auto loaded = second.load();
  loaded.addPlace({});
  EXPECT_THAT(messageOf([&] { second.commit(loaded, loaded.takeChanges()); }), HasSubstr("another program"));
  EXPECT_EQ(reader.load().places().size(), 6u);
}

/// The log stays beside the file then, and the next writer folds it in.
TEST_F(SharingTest, AWriterClosesWhileAnotherProgramReads) {
  const std::string name = path("a.engram");
  auto map = ringMap(4);
  {
    MapFile writer = MapFile::create(name, sampleHeader());
    writer.commit(map, map.takeChanges());
    const MapFile reader = MapFile::open(name, Access::kReadOnly);
    EXPECT_EQ(reader.load().places().size(), 4u);
    writer.close();
    EXPECT_EQ(reader.load().places().size(), 4u);
  }
  MapFile::open(name, Access::kReadWrite).close();
  EXPECT_FALSE(std::filesystem::exists(name + "-wal"));
  EXPECT_EQ(text({}, MapFile::open(name, Access::kReadOnly).load().content()), text({}, map.content()));
}

/// A reader may be between two rows when the next session begins.
TEST_F(SharingTest, AWriterWaitsForAnotherProgramThatReads) {
  const std::string name = path("a.engram");
  auto map = ringMap(4);
  {
    MapFile writer = MapFile::create(name, sampleHeader());
    writer.commit(map, map.takeChanges());
  }
  sqlite3* reader = nullptr;
  sqlite3_stmt* rows = nullptr;
  ASSERT_EQ(sqlite3_open_v2(name.c_str(), &reader, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  ASSERT_EQ(sqlite3_prepare_v2(reader, "SELECT data FROM places", -1, &rows, nullptr), SQLITE_OK);
  ASSERT_EQ(sqlite3_step(rows), SQLITE_ROW);
  std::thread reads([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    sqlite3_finalize(rows);
    sqlite3_close(reader);
  });
  EXPECT_NO_THROW({
    MapFile writer = MapFile::open(name, Access::kReadWrite);
    map.addPlace({});
    writer.commit(map, map.takeChanges());
    EXPECT_EQ(writer.load().places().size(), 5u);
  });
  reads.join();
}

}  // namespace
}  // namespace engram::store
