// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// The index that lies beside a map, from drive to drive.
#include "engram/store/map_file.h"
#include "map_program.h"
#include "run_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <map>

namespace engram::apps {
namespace {

using map::DerivedKind;
using ::testing::HasSubstr;

using Rows = std::map<std::uint32_t, std::vector<std::uint8_t>>;

class IndexRunTest : public RunTest {
 protected:
  void SetUp() override {
    RunTest::SetUp();
    map_ = path("m.engram");
    const std::vector<std::string> small{"--set", "recognise.exhaustive_places=10", "--set",
                                         "recognise.proposals=8"};
    std::vector<std::string> arguments{config(), "--rawlog", rawlog(1), "--map", map_, "-q"};
    arguments.insert(arguments.end(), small.begin(), small.end());
    const RunResult made = slam(arguments);
    ASSERT_EQ(made.code, kOk) << made.err;
    // The words of so small a map are still being learnt when its first drive ends.
    ASSERT_EQ(runAs<MapProgram>({"index", map_, "-q"}).code, kOk);
  }

  Rows rows(DerivedKind kind) const {
    Rows found;
    store::MapFile::open(map_, store::Access::kReadOnly)
        .loadOnDemand()
        .content()
        .derived->read(kind,
                       [&](std::uint32_t id, auto data) { found[id].assign(data.begin(), data.end()); });
    return found;
  }
  std::size_t places() const {
    return store::MapFile::open(map_, store::Access::kReadOnly).load().places().size();
  }
  /// Name of the place of each image, with the memories read on demand.
  std::string answers(const std::string& name) const {
    const RunResult run = localize({"--map", map_, "--rawlog", rawlog(2), "--out", path(name), "-q"});
    EXPECT_EQ(run.code, kOk) << run.err;
    std::string all, line;
    std::ifstream csv(path(name));
    while (std::getline(csv, line)) {
      for (int field = 0; field < 8; ++field)
        all += line.substr(0, line.find(',')) + ' ', line.erase(0, line.find(',') + 1);
      all += '\n';
    }
    return all;
  }
  void sql(const std::string& statement) const {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(map_.c_str(), &database), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(database, statement.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(database);
  }

  std::string map_;
};

TEST_F(IndexRunTest, IsMadeAnewWhenItIsNotThere) {
  EXPECT_EQ(rows(DerivedKind::kWords).size(), 1u);
  const Rows words = rows(DerivedKind::kPlaceWords), signatures = rows(DerivedKind::kSignature);
  EXPECT_EQ(words.size(), places());
  EXPECT_EQ(signatures.size(), places());
  soundImages(map_);
  const std::string before = bytesOf(map_), found = answers("kept.csv");
  EXPECT_EQ(bytesOf(map_), before);

  // Each of these rows is as good as missing: the answers stay.
  sql("UPDATE derived SET data = zeroblob(length(data)) WHERE kind = 65 OR (kind = 73 AND id % 2 = 0)");
  EXPECT_EQ(answers("damaged.csv"), found);
  sql("DELETE FROM derived WHERE kind = 65 OR (kind = 73 AND id % 3 = 0)");
  EXPECT_EQ(answers("missing.csv"), found);

  const RunResult indexed = runAs<MapProgram>({"index", map_});
  ASSERT_EQ(indexed.code, kOk) << indexed.err;
  EXPECT_EQ(rows(DerivedKind::kPlaceWords), words);
  EXPECT_EQ(rows(DerivedKind::kSignature), signatures);
  EXPECT_EQ(answers("again.csv"), found);
  EXPECT_THAT(runAs<MapProgram>({"index", map_}).out, HasSubstr("0 rows of the index made"));

  sql("DELETE FROM derived");
  ASSERT_EQ(runAs<MapProgram>({"index", map_, "-q"}).code, kOk);
  EXPECT_EQ(rows(DerivedKind::kPlaceWords).size(), places());
  EXPECT_EQ(rows(DerivedKind::kSignature), signatures);
  soundImages(map_);
}

/// Places that learn are indexed anew, the others are left alone.
TEST_F(IndexRunTest, FollowsWhatPlacesLearn) {
  const Rows before = rows(DerivedKind::kPlaceWords);
  const RunResult adapted = localize({"--map", map_, "--rawlog", rawlog(2), "--adapt", "-q"});
  ASSERT_EQ(adapted.code, kOk) << adapted.err;
  const Rows after = rows(DerivedKind::kPlaceWords);
  EXPECT_EQ(after.size(), places());
  std::size_t changed = 0;
  for (const auto& [place, row] : after) changed += before.at(place) != row;
  EXPECT_GT(changed, 3u);
  EXPECT_THAT(runAs<MapProgram>({"index", map_}).out, HasSubstr("0 rows of the index made"));
  soundImages(map_);
}

}  // namespace
}  // namespace engram::apps
