// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What is saved of damaged maps, compared with what was there: nothing that is kept differs from the truth,
// the new map is sound, and what is missing is said.
#include "engram/store/map_copy.h"
#include "sample_map.h"
#include "store_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <set>

namespace engram::store {
namespace {

using engram::testing::ringMap;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
namespace fs = std::filesystem;

class RecoverTest : public StoreTest {
 protected:
  static constexpr int kPlaces = 12, kRecords = 9;

  void SetUp() override {
    StoreTest::SetUp();
    name_ = path("a.engram");
    saved_ = path("b.engram");
    auto map = ringMap(kPlaces, 30);
    MapFile file = MapFile::create(name_, sampleHeader());
    file.beginDrive({.session = 0, .source = "monday.rawlog"});
    for (std::uint64_t k = 0; k < kRecords; ++k) {
      auto report = sampleReport();
      report.index = k;
      report.reason = std::string(2000, 'r');  // so that they fill several pages
      file.commit(map, map.takeChanges(), &report);
    }
    file.endDrive();
    file.close();
    good_ = fileBytes(name_);
    truth_ = linesOf(name_);
  }

  void sql(const char* statements) const {
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(name_.c_str(), &db), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(db, statements, nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(db);
    sqlite3_close(db);
  }
  /// The lines of a dump that are of single items, so that those of a part are among those of the whole. The
  /// numbers of path points are not in them.
  static std::set<std::string> linesOf(const std::string& name) {
    std::ostringstream out;
    const MapFile file = MapFile::open(name, Access::kReadOnly);
    EXPECT_THAT(file.check(), IsEmpty());
    file.dump(out);
    std::set<std::string> lines;
    std::istringstream in(out.str());
    for (std::string line; std::getline(in, line);) lines.insert(line);
    return lines;
  }
  /// Everything that was saved was in the map, but for lines that speak of what was lost: totals, and edges
  /// and memories of places whose memory is gone.
  void expectPartOfTruth(const std::string& what) const {
    for (const std::string& line : linesOf(saved_)) {
      const bool summary = line.starts_with("next ") || line.starts_with("drive ") ||
                           line.starts_with("header ") || line.starts_with("  memory updates 0") ||
                           (line.starts_with("edge ") && line.ends_with(" features"));
      if (!summary) {
        ASSERT_TRUE(truth_.contains(line)) << what << ": " << line.substr(0, 200);
      }
    }
  }

  std::string name_, saved_, good_;
  std::set<std::string> truth_;
};

TEST_F(RecoverTest, ASoundMapIsSavedWhole) {
  const Recovery r = recoverMap(name_, saved_);
  EXPECT_THAT(r.lost, IsEmpty());
  EXPECT_EQ(r.places, static_cast<std::uint64_t>(kPlaces));
  EXPECT_EQ(linesOf(saved_), truth_);
  EXPECT_EQ(fileBytes(name_), good_);
}

TEST_F(RecoverTest, WhatHangsOnALostPlaceGoesWithIt) {
  sql("UPDATE places SET data = x'00' WHERE id = 3");
  const std::string before = fileBytes(name_);
  const Recovery r = recoverMap(name_, saved_);
  EXPECT_THAT(r.lost, ::testing::Contains("1 of 12 places: number 3"));
  EXPECT_THAT(r.lost, ::testing::Contains("2 of 12 edges: number 2, 3"));
  EXPECT_THAT(r.lost, ::testing::Contains("1 of 12 views: number 3"));
  const auto map = MapFile::open(saved_, Access::kReadOnly).load();
  EXPECT_EQ(map.places().size(), 11u);
  EXPECT_FALSE(map.places().contains(map::PlaceId(3)));
  EXPECT_EQ(map.edges().size(), 10u);
  EXPECT_EQ(r.records, static_cast<std::uint64_t>(kRecords));
  expectPartOfTruth("place 3");
  EXPECT_EQ(fileBytes(name_), before);
}

TEST_F(RecoverTest, APlaceWithoutItsMemoryHoldsTheGraphTogether) {
  sql("UPDATE memories SET data = x'00' WHERE id = 5");
  const Recovery r = recoverMap(name_, saved_);
  EXPECT_THAT(r.lost, ::testing::ElementsAre("1 of 12 memories of places that are kept: number 5"));
  const auto map = MapFile::open(saved_, Access::kReadOnly).load();
  EXPECT_EQ(map.edges().size(), 12u);
  EXPECT_EQ(map.components().size(), 1u);
  EXPECT_EQ(map.place(map::PlaceId(5)).memory->states.size(), 0u);
  expectPartOfTruth("memory 5");
}

TEST_F(RecoverTest, RecordsAndPathCloseUpAndTheDriveCountsThem) {
  sql("UPDATE records SET json = 'x' WHERE id IN (2, 5); DELETE FROM path WHERE id = 4; DELETE FROM state;"
      "UPDATE header SET value = 'x' WHERE key = 'parameters'");
  const Recovery r = recoverMap(name_, saved_);
  EXPECT_EQ(r.records, kRecords - 2u);
  EXPECT_EQ(r.path, kPlaces - 1u);
  EXPECT_THAT(r.lost, ::testing::Contains("at least 2 records: number 2, 5"));
  EXPECT_THAT(r.lost, ::testing::Contains(HasSubstr("row of totals")));
  EXPECT_THAT(r.lost, ::testing::Contains("the entry 'parameters' of the header"));
  const auto drives = MapFile::open(saved_, Access::kReadOnly).drives();
  ASSERT_EQ(drives.size(), 1u);
  EXPECT_EQ(drives[0].images, kRecords - 2u);
  EXPECT_EQ(drives[0].source, "monday.rawlog");
  expectPartOfTruth("records");
}

/// One page after the other is overwritten: only what was on it is lost. The first one tells where the
/// tables are.
TEST_F(RecoverTest, EveryDamagedPageIsWalkedAround) {
  constexpr std::size_t kPage = 4096;
  std::size_t saved = 0, pages = 0;
  base::Rng rng(5);
  for (std::size_t page = 0; page < good_.size() / kPage; ++page, ++pages) {
    std::string bad = good_;
    for (std::size_t i = 0; i < kPage; ++i) bad[page * kPage + i] = static_cast<char>(rng.below(256));
    writeBytes(name_, bad);
    std::optional<Recovery> r;
    ASSERT_NO_THROW(r = recoverMap(name_, saved_, true)) << "page " << page;
    EXPECT_EQ(fileBytes(name_), bad);
    expectPartOfTruth("page " + std::to_string(page));
    saved += r->places + r->records;
    const bool all = linesOf(saved_) == truth_;
    EXPECT_TRUE(all || !r->lost.empty()) << "page " << page << ": a loss that nobody is told of";
  }
  // A page holds a table of one page, or a part of a larger one.
  EXPECT_GT(saved, pages * (kPlaces + kRecords) * 3 / 4);
}

TEST_F(RecoverTest, FlippedBytesAndTruncationLoseLittleAndNothingIsInvented) {
  base::Rng rng(17);
  int recovered = 0;
  const int trials = 60;
  for (int trial = 0; trial < trials; ++trial) {
    std::string bad = good_;
    for (std::uint32_t n = 1 + rng.below(20); n > 0; --n)
      bad[rng.below(static_cast<std::uint32_t>(bad.size()))] = static_cast<char>(rng.below(256));
    if (trial % 3 == 0) bad.resize(bad.size() / 4 + rng.below(static_cast<std::uint32_t>(bad.size() / 2)));
    writeBytes(name_, bad);
    try {
      const Recovery r = recoverMap(name_, saved_, true);
      ++recovered;
      expectPartOfTruth("trial " + std::to_string(trial));
      EXPECT_TRUE(linesOf(saved_) == truth_ || !r.lost.empty()) << "trial " << trial;
    } catch (const base::Error& e) {
      EXPECT_THAT(e.what(), HasSubstr("nothing could be recovered"));
    }
  }
  EXPECT_GT(recovered, trials * 3 / 4);
}

TEST_F(RecoverTest, WhatIsNoMapIsRefusedAndLeavesNothing) {
  writeBytes(path("text"), std::string(50000, 'x'));
  writeBytes(path("empty"), "");
  for (const char* name : {"text", "empty"})
    EXPECT_THAT(messageOf([&] { recoverMap(path(name), saved_); }), HasSubstr("nothing could be recovered"));
  EXPECT_THAT(messageOf([&] { recoverMap(path("none"), saved_); }), HasSubstr("does not exist"));
  EXPECT_FALSE(fs::exists(saved_));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 3);
}

/// Its log is gone: what is there is saved, but it is not said to be whole.
TEST_F(RecoverTest, AMissingLogIsALoss) {
  auto map = MapFile::open(name_, Access::kReadOnly).load();
  std::string copy;
  {
    MapFile writer = MapFile::open(name_, Access::kReadWrite);
    map.addPlace({});
    writer.commit(map, map.takeChanges());
    copy = fileBytes(name_);
  }
  writeBytes(path("c.engram"), copy);
  const Recovery r = recoverMap(path("c.engram"), saved_);
  EXPECT_THAT(r.lost, ::testing::ElementsAre(HasSubstr("copied without")));
  EXPECT_EQ(linesOf(saved_), truth_);
}

}  // namespace
}  // namespace engram::store
