// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// One map, a program that writes it and others that read it.
#include "engram/store/drive_writer.h"
#include "engram/store/map_file.h"
#include "sample_map.h"
#include "store_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace engram::store {
namespace {

using engram::testing::ringMap;
using ::testing::HasSubstr;

using SharingTest = StoreTest;

/// A reader sees the map as it was when it was opened, all of it of one moment.
TEST_F(SharingTest, AReaderKeepsItsMomentWhileAWriterGoesOn) {
  auto map = ringMap(4);
  const auto report = sampleReport();
  MapFile writer = MapFile::create(path("a.engram"), sampleHeader());
  writer.commit(map, map.takeChanges(), &report);
  const std::string before = text(sampleHeader(), map.content(), {report});
  const MapFile reader = MapFile::open(path("a.engram"), Access::kReadOnly);
  for (int k = 0; k < 3; ++k) {
    map.addPlace({});
    writer.commit(map, map.takeChanges(), &report);
    EXPECT_EQ(text(reader.header(), reader.load().content(), reader.records()), before);
    EXPECT_THAT(reader.check(), ::testing::IsEmpty());
  }
  EXPECT_EQ(MapFile::open(path("a.engram"), Access::kReadOnly).load().places().size(), 7u);
}

TEST_F(SharingTest, ASecondWriterIsRefusedAtItsStart) {
  auto map = ringMap(4);
  const std::string name = path("a.engram");
  {
    MapFile writer = MapFile::create(name, sampleHeader());
    writer.commit(map, map.takeChanges());
    const std::string self = "process " + std::to_string(getpid());
    std::filesystem::create_symlink(name, path("link.engram"));
    for (const std::string& way : {name, path("link.engram")}) {
      EXPECT_THAT(messageOf([&] { MapFile::open(way, Access::kReadWrite); }),
                  AllOf(HasSubstr("being written by"), HasSubstr(self), HasSubstr("since 2")));
      EXPECT_THAT(messageOf([&] { MapFile::create(way, sampleHeader(), true); }), HasSubstr(self));
      EXPECT_THAT(messageOf([&] { DriveWriter(way, {.overwrite = true}, "b"); }), HasSubstr(self));
      EXPECT_THAT(messageOf([&] { DriveWriter(way, {.extend = true}, "b"); }), HasSubstr(self));
    }
    map.addPlace({});
    writer.commit(map, map.takeChanges());
  }
  EXPECT_FALSE(std::filesystem::exists(name + "-lock"));
  EXPECT_EQ(MapFile::open(name, Access::kReadWrite).load().places().size(), 5u);
}

/// A lock that outlived its process would keep the robot out for ever.
// Two programs that start within a millisecond: the second asks before the first has signed.
TEST_F(SharingTest, AHolderThatHasNotSignedYetIsNamedAllTheSame) {
  const int holder = ::open(path("a.engram-lock").c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_GE(holder, 0);
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  ASSERT_EQ(fcntl(holder, F_OFD_SETLK, &whole), 0);
  std::thread signs([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    EXPECT_EQ(write(holder, "process 4711\n", 13), 13);
  });
  EXPECT_THAT(messageOf([&] { WriterLock lock(path("a.engram")); }),
              HasSubstr("is being written by process 4711"));
  signs.join();
  ::close(holder);
}

TEST_F(SharingTest, TheLockDiesWithItsProcess) {
  const std::string name = path("a.engram");
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const MapFile writer = MapFile::create(name, sampleHeader());
    [[maybe_unused]] const auto told = write(ready[1], "x", 1);
    pause();
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_THAT(messageOf([&] { MapFile::open(name, Access::kReadWrite); }),
              HasSubstr("process " + std::to_string(child)));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(std::filesystem::exists(name + "-lock"));
  EXPECT_NO_THROW(MapFile::open(name, Access::kReadWrite));
  close(ready[0]);
  close(ready[1]);
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
