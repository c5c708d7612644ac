// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/memory/fsh.h"
#include "engram/store/map_file.h"
#include "sample_map.h"
#include "store_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <csignal>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace engram::store {
namespace {

using engram::testing::ringMap;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class DamageTest : public StoreTest {
 protected:
  void SetUp() override {
    StoreTest::SetUp();
    name_ = path("a.engram");
    auto map = ringMap(4, 12);
    map.remember(map::PlaceId(1), memory::Fsh({}), {}, {});
    map.setStanding(map::PlaceId(3), map::Standing::kProbation, 4.5);
    const auto report = sampleReport();
    MapFile file = MapFile::create(name_, sampleHeader());
    file.commit(map, map.takeChanges(), &report);
    file.close();
    good_ = fileBytes(name_);
    truth_ = *content();
  }

  /// All that the file holds; nothing when it is refused, which must be by base::Error.
  std::optional<std::string> content() const {
    try {
      const MapFile file = MapFile::open(name_, Access::kReadOnly);
      std::ostringstream out;
      file.dump(out);
      return out.str();
    } catch (const base::Error& e) {
      EXPECT_THAT(e.what(), HasSubstr("a"));
      return std::nullopt;
    }
  }

  std::string name_, good_, truth_;
};

/// A flipped bit is found, or lies where nothing is read; it never gives another map.
TEST_F(DamageTest, FlippedBitsAreFoundOrHarmless) {
  base::Rng rng(17);
  int found = 0;
  const int trials = 1200;
  for (int trial = 0; trial < trials; ++trial) {
    std::string bad = good_;
    const auto size = static_cast<std::uint32_t>(bad.size());
    // One third in the first page, where the structure is.
    const auto at = rng.below(trial % 3 == 0 ? 4096 : size);
    bad[at] = static_cast<char>(bad[at] ^ (1 << rng.below(8)));
    writeBytes(name_, bad);
    const auto read = content();
    if (!read)
      ++found;
    else
      ASSERT_EQ(*read, truth_) << "bit flip at byte " << at;
  }
  EXPECT_GT(found, trials / 10);
}

TEST_F(DamageTest, ManyFlippedBitsAreSurvived) {
  base::Rng rng(18);
  for (int trial = 0; trial < 300; ++trial) {
    std::string bad = good_;
    for (std::uint32_t n = 1 + rng.below(400); n > 0; --n)
      bad[100 + rng.below(static_cast<std::uint32_t>(bad.size()) - 100)] = static_cast<char>(rng.below(256));
    writeBytes(name_, bad);
    const auto read = content();
    ASSERT_EQ(read.value_or(truth_), truth_);
  }
}

TEST_F(DamageTest, TruncatedFilesAreRefused) {
  for (std::size_t size = 0; size < good_.size(); size += size < 600 ? 37 : 511) {
    writeBytes(name_, good_.substr(0, size));
    EXPECT_FALSE(content()) << size << " of " << good_.size() << " bytes";
  }
}

/// A page that is a stale copy of another one has good checksums in wrong rows.
TEST_F(DamageTest, SwappedPagesAreFound) {
  constexpr std::size_t kPage = 4096;
  int found = 0;
  for (std::size_t a = 1; a < good_.size() / kPage; ++a)
    for (std::size_t b = 1; b < good_.size() / kPage; ++b) {
      if (a == b) continue;
      std::string bad = good_;
      bad.replace(a * kPage, kPage, good_, b * kPage, kPage);
      writeBytes(name_, bad);
      const auto read = content();
      if (!read)
        ++found;
      else
        ASSERT_EQ(*read, truth_) << "page " << b << " over page " << a;
    }
  EXPECT_GT(found, 0);
}

TEST_F(DamageTest, CheckListsTheDamagedRows) {
  const auto at = good_.find("image_2.png");
  ASSERT_NE(at, std::string::npos);
  std::string bad = good_;
  bad[at] = 'X';
  writeBytes(name_, bad);
  const auto problems = MapFile::open(name_, Access::kReadOnly).check();
  ASSERT_THAT(problems, Not(IsEmpty()));
  EXPECT_THAT(problems.front(), HasSubstr("place 2: its checksum is wrong"));
  EXPECT_THAT(messageOf([&] { MapFile::open(name_, Access::kReadOnly).load(); }),
              HasSubstr("place 2: its checksum is wrong"));
}

/// Another journal mode than ours may have been cut off in the middle of a commit: the commit is undone, then
/// read.
TEST_F(DamageTest, CutOffCommitIsUndone) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    sqlite3* db = nullptr;
    sqlite3_open(name_.c_str(), &db);
    sqlite3_exec(db,
                 "PRAGMA cache_size = 1; PRAGMA journal_mode = DELETE; BEGIN; DELETE FROM memories;"
                 "UPDATE places SET data = zeroblob(20000); UPDATE views SET data = zeroblob(20000);",
                 nullptr, nullptr, nullptr);
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(std::filesystem::exists(name_ + "-journal"));
  ASSERT_NE(fileBytes(name_), good_);
  EXPECT_EQ(content().value_or("refused"), truth_);
  EXPECT_FALSE(std::filesystem::exists(name_ + "-journal"));
}

/// A file size limit is the disk that is full: the commit fails as a whole, and what was there stays.
TEST_F(DamageTest, FullDiskLosesNothingThatWasCommitted) {
  MapFile file = MapFile::open(name_, Access::kReadWrite);
  auto map = file.load();
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = old;
  small.rlim_cur = 100000;
  setrlimit(RLIMIT_FSIZE, &small);
  std::string message = "no base::Error";
  base::Rng rng(1);
  for (int i = 0; i < 10 && message == "no base::Error"; ++i) {
    map::Place place;
    place.memory = engram::testing::randomMemory(rng, 300, 4);
    map.addPlace(place);
    message = messageOf([&] { file.commit(map, map.takeChanges()); });
  }
  setrlimit(RLIMIT_FSIZE, &old);
  EXPECT_THAT(message, HasSubstr(name_));
  EXPECT_THAT(message, HasSubstr("disk"));
  EXPECT_THAT(message, HasSubstr("What was committed before is safe"));
  EXPECT_GE(MapFile::open(name_, Access::kReadOnly).load().places().size(), 4u);
  EXPECT_THAT(MapFile::open(name_, Access::kReadOnly).check(), IsEmpty());
}

}  // namespace
}  // namespace engram::store
