// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/store/map_file.h"
#include "sample_map.h"
#include "store_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

namespace engram::store {
namespace {

using engram::testing::ringMap;
using ::testing::AllOf;
using ::testing::HasSubstr;

class RefusalTest : public StoreTest {
 protected:
  void writeMap(const std::string& name) const {
    auto map = ringMap(3, 4);
    MapFile::create(path(name), sampleHeader()).commit(map, map.takeChanges());
  }
  void sql(const std::string& name, const char* statements) const {
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(path(name).c_str(), &db), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(db, statements, nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(db);
    sqlite3_close(db);
  }
  std::string whyNot(const std::string& name, Access access = Access::kReadOnly) const {
    return messageOf([&] { MapFile::open(path(name), access).load(); });
  }
};

TEST_F(RefusalTest, WhatIsNotAMap) {
  EXPECT_THAT(whyNot("none"), HasSubstr("does not exist"));
  writeBytes(path("empty"), "");
  EXPECT_THAT(whyNot("empty"), HasSubstr("is empty"));
  std::filesystem::create_directory(path("folder"));
  EXPECT_THAT(whyNot("folder"), HasSubstr("is not a file"));
  writeBytes(path("text"), std::string(5000, 'x'));
  for (const Access access : {Access::kReadOnly, Access::kReadWrite}) {
    EXPECT_THAT(whyNot("text", access), AllOf(HasSubstr("text"), HasSubstr("not an Engram map")));
    sql("other", "CREATE TABLE IF NOT EXISTS t (x)");
    const std::string before = fileBytes(path("other"));
    EXPECT_THAT(whyNot("other", access), HasSubstr("not an Engram map"));
    EXPECT_EQ(fileBytes(path("other")), before);  // another program's database is not touched
  }
}

TEST_F(RefusalTest, NewerVersion) {
  writeMap("a");
  sql("a", "PRAGMA user_version = 4");
  for (const Access access : {Access::kReadOnly, Access::kReadWrite})
    EXPECT_THAT(whyNot("a", access), AllOf(HasSubstr("format 4"), HasSubstr("newer Engram")));
  sql("a", "PRAGMA user_version = 0");
  EXPECT_THAT(whyNot("a"), HasSubstr("no format version"));
}

TEST_F(RefusalTest, MissingRowsTablesAndHeaders) {
  const std::pair<const char*, const char*> cases[] = {
      {"DELETE FROM places WHERE id = 1", "2 rows of the kind 'place' where 3 were written"},
      {"DELETE FROM edges WHERE id = 0", "kind 'edge'"},
      {"DELETE FROM memories WHERE id = 2", "kind 'memory of place'"},
      {"DELETE FROM path WHERE id = 2", "kind 'path point'"},
      {"DELETE FROM state", "row of totals"},
      {"DELETE FROM header WHERE key = 'camera'", "header 'camera' is missing"},
      {"UPDATE header SET value = 'akaze' WHERE key = 'extractor'", "header 'extractor': its checksum"},
      {"UPDATE places SET data = (SELECT data FROM places WHERE id = 0) WHERE id = 1",
       "place 1: its checksum"},
      {"UPDATE places SET id = -5 WHERE id = 1", "out of range"},
      {"DROP TABLE views", "damaged"},
      {"UPDATE memories SET data = x'' WHERE id = 0", "memory of place 0: a row is too short"},
      {"UPDATE memories SET data = 17 WHERE id = 0", "memory of place 0"}};
  for (const auto& [damage, message] : cases) {
    std::filesystem::remove(path("a"));
    writeMap("a");
    sql("a", damage);
    EXPECT_THAT(whyNot("a"), HasSubstr(message)) << damage;
  }
}

TEST_F(RefusalTest, PathThatExists) {
  writeMap("a");
  const std::string before = fileBytes(path("a"));
  EXPECT_THAT(messageOf([&] { MapFile::create(path("a"), sampleHeader()); }),
              AllOf(HasSubstr(path("a")), HasSubstr("exists already")));
  EXPECT_EQ(fileBytes(path("a")), before);
  EXPECT_EQ(MapFile::create(path("a"), sampleHeader(), true).load().places().size(), 0u);
  writeBytes(path("letter"), "dear map");
  EXPECT_THAT(messageOf([&] { MapFile::create(path("letter"), sampleHeader(), true); }),
              HasSubstr("is not an Engram map"));
  EXPECT_EQ(fileBytes(path("letter")), "dear map");
}

TEST_F(RefusalTest, PathsThatCannotBe) {
  EXPECT_THAT(messageOf([&] { MapFile::create(path("no/such/a"), sampleHeader()); }),
              HasSubstr("does not exist"));
  EXPECT_THAT(messageOf([&] { MapFile::create("", sampleHeader()); }), HasSubstr("needs a file name"));
  EXPECT_THAT(messageOf([&] { MapFile::create("/proc/a.engram", sampleHeader()); }),
              HasSubstr("/proc/a.engram"));
  // Names that mean something to SQLite are plain names here.
  for (const char* name : {"a b?mode=memory", "100%23#.engram", ":memory:"}) {
    writeMap(name);
    EXPECT_EQ(whyNot(name), "no base::Error") << name;
    EXPECT_TRUE(std::filesystem::exists(path(name)));
  }
}

TEST_F(RefusalTest, WrongUse) {
  writeMap("a");
  map::TopologicalMap map;
  MapFile reader = MapFile::open(path("a"), Access::kReadOnly);
  EXPECT_THAT(messageOf([&] { reader.commit(map, map.takeChanges()); }), HasSubstr("reading only"));
  reader.close();
  reader.close();
  EXPECT_THAT(messageOf([&] { reader.load(); }), HasSubstr("is closed"));
}

TEST(Compatibility, NamesWhatDiffers) {
  const map::MapHeader stored = sampleHeader();
  const auto why = [&](auto&& change) {
    map::MapHeader wanted = stored;
    change(wanted);
    try {
      requireCompatible(stored, wanted, "office.engram");
    } catch (const base::ConfigError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(why([](map::MapHeader&) {}), "");
  EXPECT_EQ(why([](map::MapHeader& h) { h.parameters = "other", h.engramVersion = "9", h.firstStamp = 0; }),
            "");
  EXPECT_THAT(why([](map::MapHeader& h) { h.camera = "model = unified_sphere\nxi = 0.9\nwidth = 640\n"; }),
              AllOf(HasSubstr("office.engram"), HasSubstr("camera 'xi = 0.95'"), HasSubstr("'xi = 0.9'")));
  EXPECT_THAT(why([](map::MapHeader& h) { h.camera += "more\n"; }), HasSubstr("'(end)'"));
  EXPECT_THAT(why([](map::MapHeader& h) { h.camera.pop_back(); }), HasSubstr("camera"));
  EXPECT_THAT(why([](map::MapHeader& h) { h.extractor = "akaze"; }),
              AllOf(HasSubstr("extractor 'surf'"), HasSubstr("has 'akaze'")));
  EXPECT_THAT(why([](map::MapHeader& h) { h.descriptorKind = types::DescriptorKind::kFloat; }),
              HasSubstr("'float'"));
  EXPECT_THAT(why([](map::MapHeader& h) { h.descriptorDim = 128; }), HasSubstr("'128'"));
  EXPECT_THAT(why([](map::MapHeader& h) { h.memoryModel = "static"; }), HasSubstr("memory model 'fsh'"));
}

}  // namespace
}  // namespace engram::store
