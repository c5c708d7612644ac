// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Whole copies of maps: of closed ones, of those in use and of those whose writer was killed.
#include "engram/store/map_copy.h"
#include "sample_map.h"
#include "store_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace engram::store {
namespace {

using engram::testing::planarPose;
using engram::testing::ringMap;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
namespace fs = std::filesystem;

class CopyTest : public StoreTest {
 protected:
  void SetUp() override {
    StoreTest::SetUp();
    from_ = path("a.engram");
    to_ = path("b.engram");
  }
  static std::string dumpOf(const std::string& name) {
    std::ostringstream out;
    const MapFile file = MapFile::open(name, Access::kReadOnly);
    EXPECT_THAT(file.check(), IsEmpty());
    file.dump(out);
    return out.str();
  }
  void write() const {
    auto map = ringMap(6);
    const auto report = sampleReport();
    MapFile::create(from_, sampleHeader()).commit(map, map.takeChanges(), &report);
  }
  /// Commits `images` and dies.
  void crash(int images) const {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      auto map = ringMap(6);
      const auto report = sampleReport();
      MapFile file = MapFile::create(from_, sampleHeader());
      for (int k = 0; k < images; ++k) {
        map.setPose(map::PlaceId(1), planarPose(k, 0, 0));
        file.commit(map, map.takeChanges(), &report);
      }
      kill(getpid(), SIGKILL);
    }
    waitpid(child, nullptr, 0);
    ASSERT_TRUE(fs::exists(from_ + "-wal"));
  }
  std::size_t filesInFolder() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), {}));
  }

  std::string from_, to_;
};

TEST_F(CopyTest, EqualsTheMapAndStandsAlone) {
  write();
  const std::string before = fileBytes(from_);
  copyMap(from_, to_);
  EXPECT_EQ(dumpOf(to_), dumpOf(from_));
  EXPECT_EQ(fileBytes(from_), before);
  EXPECT_EQ(filesInFolder(), 2u);
  EXPECT_EQ(fileBytes(to_)[18], 1) << "it must not speak of a log";
  EXPECT_THAT(missingLog(to_), IsEmpty());
}

/// Between the commits of a writer, each copy is the map of one of them.
TEST_F(CopyTest, OfAMapThatIsBeingWritten) {
  auto map = ringMap(6);
  const auto report = sampleReport();
  MapFile writer = MapFile::create(from_, sampleHeader());
  for (int k = 0; k < 5; ++k) {
    map.setPose(map::PlaceId(1), planarPose(k, 0, 0));
    writer.commit(map, map.takeChanges(), &report);
    copyMap(from_, to_, true);
    EXPECT_EQ(text({}, MapFile::open(to_, Access::kReadOnly).load().content()), text({}, map.content()));
    EXPECT_EQ(MapFile::open(to_, Access::kReadOnly).records().size(), static_cast<std::size_t>(k) + 1);
  }
}

/// A writer that never stops, in a process of its own: whatever moment a copy is of, it is one moment.
TEST_F(CopyTest, WhileAnotherProcessCommits) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    auto map = ringMap(6);
    auto report = sampleReport();
    MapFile writer = MapFile::create(from_, sampleHeader());
    for (std::uint64_t k = 0;; ++k) {
      report.index = k;
      map.survey(map::PlaceId(1), planarPose(static_cast<double>(k), 0, 0));
      writer.commit(map, map.takeChanges(), &report);
      if (k == 0) [[maybe_unused]]
        const auto told = ::write(ready[1], "x", 1);
      // The map must not outgrow a reader that sanitizers make slow.
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  for (int k = 0; k < 20; ++k) {
    copyMap(from_, to_, true);
    const MapFile copy = MapFile::open(to_, Access::kReadOnly);
    EXPECT_THAT(copy.check(), IsEmpty());
    const auto records = copy.records();
    const auto map = copy.load();
    ASSERT_FALSE(records.empty());
    EXPECT_EQ(map.place(map::PlaceId(1)).T_world_place->translation().x(),
              static_cast<double>(records.back().index));
    EXPECT_EQ(records.size(), records.back().index + 1);
  }
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  close(ready[0]);
  close(ready[1]);
}

TEST_F(CopyTest, OfACrashedMapWithItsLog) {
  for (const int images : {1, 40}) {
    for (const char* suffix : {"", "-wal", "-shm", "-lock"}) fs::remove(from_ + suffix);
    crash(images);
    const std::string file = fileBytes(from_), log = fileBytes(from_ + "-wal");
    copyMap(from_, to_, true);
    EXPECT_EQ(MapFile::open(to_, Access::kReadOnly).records().size(), static_cast<std::size_t>(images));
    EXPECT_EQ(fileBytes(from_), file);
    EXPECT_EQ(fileBytes(from_ + "-wal"), log);
    EXPECT_EQ(dumpOf(to_), dumpOf(from_));
  }
}

/// Without the index of the log, which only who may write the folder can make.
TEST_F(CopyTest, OfACrashedMapInAReadOnlyFolder) {
  crash(3);
  fs::remove(from_ + "-shm");
  fs::remove(from_ + "-lock");
  const fs::path locked = folder_ / "locked", open = folder_ / "open";
  fs::create_directory(locked);
  fs::create_directory(open);
  fs::permissions(open, fs::perms::all);
  for (const char* suffix : {"", "-wal"}) fs::rename(from_ + suffix, (locked / "a.engram").string() + suffix);
  const std::string expected = (locked / "a.engram").string(), copy = (open / "b.engram").string();
  fs::permissions(folder_, fs::perms(0755));
  fs::permissions(locked, fs::perms(0555));
  const bool root = geteuid() == 0;
  ASSERT_EQ(root ? seteuid(65534) : 0, 0);
  const std::string message = messageOf([&] { MapFile::open(expected, Access::kReadOnly); });
  const std::string copied = messageOf([&] { copyMap(expected, copy); });
  ASSERT_EQ(root ? seteuid(0) : 0, 0);
  fs::permissions(locked, fs::perms(0755));
  EXPECT_THAT(message, HasSubstr("was cut off, and its log '" + expected + "-wal'"));
  EXPECT_THAT(message, HasSubstr("engram-map copy"));
  EXPECT_EQ(copied, "no base::Error");
  EXPECT_EQ(MapFile::open(copy, Access::kReadOnly).records().size(), 3u);
  EXPECT_EQ(dumpOf(copy), dumpOf(expected));
}

TEST_F(CopyTest, ReplacesMapsOnlyAndOnlyWhenAsked) {
  write();
  const auto why = [&](const std::string& to, bool overwrite) {
    return messageOf([&] { copyMap(from_, to, overwrite); });
  };
  copyMap(from_, to_);
  EXPECT_THAT(why(to_, false), HasSubstr("exists already"));
  writeBytes(path("letter"), "dear map");
  EXPECT_THAT(why(path("letter"), true), HasSubstr("not an Engram map"));
  EXPECT_EQ(fileBytes(path("letter")), "dear map");
  fs::create_symlink(to_, path("link"));
  EXPECT_THAT(why(path("link"), true), HasSubstr("not overwritten"));
  EXPECT_TRUE(fs::is_symlink(path("link")));
  fs::create_directory(path("folder"));
  EXPECT_THAT(why(path("folder"), true), HasSubstr("not overwritten"));
  EXPECT_THAT(why(from_, true), HasSubstr("the map itself"));
  EXPECT_THAT(why(path("no/such"), false), HasSubstr("does not exist"));
  EXPECT_THAT(messageOf([&] { copyMap(path("none"), to_, true); }), HasSubstr("does not exist"));
  MapFile writer = MapFile::open(to_, Access::kReadWrite);
  EXPECT_THAT(why(to_, true), HasSubstr("being written by"));
  EXPECT_EQ(filesInFolder(), 6u);  // two maps, letter, link, folder and the lock of the writer
}

/// A damaged copy over a good one would be the loss that the copy was made against.
TEST_F(CopyTest, ADamagedMapIsNotCopiedOverAGoodOne) {
  write();
  copyMap(from_, to_);
  const std::string good = fileBytes(to_);
  std::string bad = fileBytes(from_);
  bad[bad.find("image_2.png")] = 'X';
  writeBytes(from_, bad);
  EXPECT_THAT(messageOf([&] { copyMap(from_, to_, true); }),
              AllOf(HasSubstr("place 2: its checksum is wrong"), HasSubstr("engram-map recover")));
  EXPECT_EQ(fileBytes(to_), good);
  EXPECT_EQ(filesInFolder(), 2u);
}

}  // namespace
}  // namespace engram::store
