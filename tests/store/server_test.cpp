// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/error.h"
#include "engram/store/drive_writer.h"
#include "engram/store/map_copy.h"
#include "postgres_server.h"
#include "sample_map.h"
#include "store_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

namespace engram::store {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// The same map in a file and on a server.
class ServerTest : public StoreTest {
 protected:
  static void SetUpTestSuite() {
    if (engram::testing::PostgresServer::installed())
      server_ = std::make_unique<engram::testing::PostgresServer>();
  }
  static void TearDownTestSuite() { server_.reset(); }
  void SetUp() override {
    StoreTest::SetUp();
    if (server_) {
      ASSERT_TRUE(server_->started());
      return;
    }
    ASSERT_EQ(std::getenv("CI"), nullptr) << "PostgreSQL is not installed: scripts/setup.sh does it";
    GTEST_SKIP() << "no PostgreSQL 15 here: apt-get install postgresql";
  }
  /// A map of this test alone.
  static std::string address(const std::string& role = "postgres") {
    std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    for (char& c : name) c = static_cast<char>(std::tolower(c));
    return server_->map(name, role);
  }
  static std::string dumpOf(const std::string& map) {
    std::ostringstream out;
    MapFile::open(map, Access::kReadOnly).dump(out);
    return out.str();
  }
  /// A drive in three commits, and one that is cut off.
  static void write(const std::string& map) {
    MapFile file = MapFile::create(map, sampleHeader());
    map::TopologicalMap content = engram::testing::ringMap(8);
    types::FrameReport report = sampleReport();
    file.beginDrive({.session = 0, .source = "a", .fingerprint = 1});
    file.commit(content, content.takeChanges(), &report);
    content.setPose(map::PlaceId(3), engram::testing::planarPose(1, 2, 3));
    file.commit(content, content.takeChanges(), &report);
    file.endDrive();
    file.beginDrive({.session = 1, .source = "b", .fingerprint = 2});
    content.removePlace(map::PlaceId(5), map::PlaceId(4));
    file.commit(content, content.takeChanges(), &report);
  }
  /// All rows of a file as SQLite has them.
  static std::string rowsOf(const std::string& path) {
    sqlite3* db = nullptr;
    sqlite3_open(path.c_str(), &db);
    std::string rows;
    for (const char* sql : {"SELECT key||value||crc FROM header ORDER BY 1", "SELECT hex(data) FROM state",
                            "SELECT id||hex(data) FROM places", "SELECT id||hex(data) FROM memories",
                            "SELECT id||hex(data) FROM views", "SELECT id||hex(data) FROM edges",
                            "SELECT id||hex(data) FROM path", "SELECT id||json||crc FROM records",
                            "SELECT id||hex(data) FROM drives", "SELECT kind||' '||id||hex(data) FROM undo"})
      sqlite3_exec(
          db, sql,
          [](void* out, int, char** value, char**) {
            (*static_cast<std::string*>(out) += value[0]) += '\n';
            return 0;
          },
          &rows, nullptr);
    sqlite3_close(db);
    return rows;
  }

  static std::unique_ptr<engram::testing::PostgresServer> server_;
};

std::unique_ptr<engram::testing::PostgresServer> ServerTest::server_;

TEST_F(ServerTest, HoldsWhatAFileHolds) {
  write(path("m"));
  write(address());
  EXPECT_EQ(dumpOf(address()), dumpOf(path("m")));
  const MapFile file = MapFile::open(address(), Access::kReadOnly);
  EXPECT_THAT(file.check(), IsEmpty());
  EXPECT_GT(file.bytes(), 8192u);
}

TEST_F(ServerTest, CopiesBothWaysBitByBit) {
  write(path("m"));
  copyMap(path("m"), address());
  EXPECT_EQ(dumpOf(address()), dumpOf(path("m")));
  copyMap(address(), path("back"));
  EXPECT_EQ(rowsOf(path("back")), rowsOf(path("m")));  // what takes back the drive that was cut off, too
  EXPECT_THAT(rowsOf(path("m")), HasSubstr("80 5"));
  EXPECT_THAT(messageOf([&] { copyMap(path("m"), address()); }), HasSubstr("exists already"));
  copyMap(path("m"), address(), true);
  copyMap(address(), server_->map("another"));
  EXPECT_EQ(dumpOf(server_->map("another")), dumpOf(path("m")));
}

TEST_F(ServerTest, ADriveThatWasCutOffIsTakenBack) {
  write(path("m"));
  write(address());
  const auto content = [](const std::string& map) {
    MapFile file = MapFile::open(map, Access::kReadWrite);
    return text(sampleHeader(), file.loadBeforeLastDrive().content());
  };
  const std::string before = content(address());
  EXPECT_EQ(before, content(path("m")));
  EXPECT_THAT(before, HasSubstr("place 5 "));
}

TEST_F(ServerTest, OneWriterAndReadersOfOneMoment) {
  write(address());
  MapFile writer = MapFile::open(address(), Access::kReadWrite);
  EXPECT_THAT(messageOf([&] { MapFile::open(address(), Access::kReadWrite); }),
              AllOf(HasSubstr("is being written by engram"), HasSubstr("One program at a time")));
  const MapFile reader = MapFile::open(address(), Access::kReadOnly);
  map::TopologicalMap map = writer.load();
  map::Cursor cursor = map.now();
  map.setPose(map::PlaceId(1), engram::testing::planarPose(9, 9, 0));
  writer.commit(map, map.changesSince(cursor));
  EXPECT_NE(reader.load().place(map::PlaceId(1)).T_map_place.translation().x(), 9);
  EXPECT_EQ(
      MapFile::open(address(), Access::kReadOnly).load().place(map::PlaceId(1)).T_map_place.translation().x(),
      9);
  writer.close();
  EXPECT_NO_THROW(MapFile::open(address(), Access::kReadWrite));
}

TEST_F(ServerTest, ACommitThatFailsLeavesTheOneBefore) {
  write(address());
  const std::string before = dumpOf(address());
  MapFile writer = MapFile::open(address(), Access::kReadWrite);
  map::TopologicalMap map = writer.load();
  map::Cursor cursor = map.now();
  map.setPose(map::PlaceId(1), engram::testing::planarPose(9, 9, 0));
  ASSERT_TRUE(server_->stop());  // as by a crash
  EXPECT_THAT(messageOf([&] { writer.commit(map, map.changesSince(cursor)); }),
              HasSubstr("map 'postgresql://"));
  EXPECT_THAT(messageOf([&] { MapFile::open(address(), Access::kReadOnly); }),
              HasSubstr("cannot be reached"));
  ASSERT_TRUE(server_->start());
  EXPECT_EQ(dumpOf(address()), before);
  EXPECT_THAT(MapFile::open(address(), Access::kReadOnly).check(), IsEmpty());
}

TEST_F(ServerTest, DamagedRowsAreFound) {
  write(address());
  ASSERT_TRUE(
      server_->sql("UPDATE engram_damagedrowsarefound.places SET data = set_byte(data, 9, 1 - get_byte(data, "
                   "9) % 2) WHERE id = 2"));
  const auto problems = MapFile::open(address(), Access::kReadOnly).check();
  ASSERT_FALSE(problems.empty());
  EXPECT_THAT(problems.front(), HasSubstr("place 2"));
  EXPECT_THAT(messageOf([&] { copyMap(address(), path("c")); }), HasSubstr("damaged"));
  EXPECT_FALSE(std::filesystem::exists(path("c")));
}

TEST_F(ServerTest, RolesMayWhatTheyMay) {
  ASSERT_TRUE(
      server_->sql("CREATE ROLE engram_reader LOGIN; CREATE ROLE engram_robot LOGIN; CREATE ROLE "
                   "engram_keeper LOGIN; GRANT CREATE ON DATABASE fleet TO engram_keeper"));
  write(address("engram_keeper"));
  const std::string before = dumpOf(address("engram_reader"));
  const auto touch = [&](const std::string& role) {
    MapFile file = MapFile::open(address(role), Access::kReadWrite);
    map::TopologicalMap map = file.load();
    map::Cursor cursor = map.now();
    map.setPose(map::PlaceId(1), engram::testing::planarPose(7, 7, 0));
    file.commit(map, map.changesSince(cursor));
  };
  EXPECT_THAT(messageOf([&] { touch("engram_reader"); }),
              AllOf(HasSubstr("permission denied"), HasSubstr("engram_robot writes")));
  EXPECT_EQ(dumpOf(address("engram_reader")), before);
  touch("engram_robot");
  EXPECT_NE(dumpOf(address("engram_reader")), before);
  EXPECT_THAT(messageOf([&] { MapFile::create(server_->map("other", "engram_robot"), sampleHeader()); }),
              HasSubstr("engram_keeper makes them"));
}

TEST_F(ServerTest, NewerFormatsAreRefused) {
  write(address());
  ASSERT_TRUE(server_->sql("UPDATE engram_newerformatsarerefused.format SET version = 99"));
  EXPECT_THAT(messageOf([&] { MapFile::open(address(), Access::kReadOnly); }), HasSubstr("has format 99"));
}

TEST_F(ServerTest, AReplicaReadsAndTakesOver) {
  write(address());
  ASSERT_TRUE(server_->startReplica());
  const std::string replica = server_->replicaOf(address());
  EXPECT_EQ(dumpOf(replica), dumpOf(address()));
  const auto move = [](const std::string& map) {
    MapFile file = MapFile::open(map, Access::kReadWrite);
    map::TopologicalMap content = file.load();
    map::Cursor cursor = content.now();
    content.setPose(map::PlaceId(1), engram::testing::planarPose(6, 6, 0));
    file.commit(content, content.changesSince(cursor));
  };
  EXPECT_THAT(messageOf([&] { move(replica); }), HasSubstr("write to its primary"));
  move(address());
  const std::string before = dumpOf(address());
  for (int i = 0; i < 1000 && dumpOf(replica) != before; ++i) ::usleep(5000);  // it may be behind
  ASSERT_TRUE(server_->stop());
  ASSERT_TRUE(server_->promote());
  EXPECT_EQ(dumpOf(replica), before);
  move(replica);
  EXPECT_THAT(MapFile::open(replica, Access::kReadOnly).check(), IsEmpty());
  ASSERT_TRUE(server_->start());  // for the tests that follow
}

TEST_F(ServerTest, ACopyIsOfOneMomentWhileAnotherWrites) {
  write(address());
  const std::string before = dumpOf(address());
  MapFile writer = MapFile::open(address(), Access::kReadWrite);
  copyMap(address(), path("copy"));
  EXPECT_EQ(dumpOf(path("copy")), before);
  EXPECT_THAT(messageOf([&] { copyMap(path("copy"), address(), true); }), HasSubstr("is being written by"));
}

TEST(ServerAddress, WhatIsWrongIsSaid) {
  const auto message = [](const std::string& map) {
    return messageOf([&] { MapFile::open(map, Access::kReadOnly); });
  };
  EXPECT_THAT(message("postgresql://host/db"), HasSubstr("?map=NAME"));
  EXPECT_THAT(message("postgresql://host/db?map=A B"), HasSubstr("lower-case"));
  for (const char* secret :
       {"postgresql://me:secret@host/db?map=a", "postgresql://host/db?map=a&password=secret"})
    EXPECT_THAT(message(secret), AllOf(HasSubstr("pgpass"), Not(HasSubstr("secret"))));
  EXPECT_THAT(message("postgresql://127.0.0.1:1/db?map=a"), HasSubstr("cannot be reached"));
}

}  // namespace
}  // namespace engram::store
