// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// Maps whose memories stay in the file until they are asked for, and what is kept beside maps.
#include "sample_map.h"
#include "store_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <chrono>
#include <map>
#include <thread>

namespace engram::store {
namespace {

using engram::testing::randomMemory;
using engram::testing::ringMap;
using map::DerivedKind;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Bytes = std::vector<std::uint8_t>;
using Rows = std::map<std::uint32_t, Bytes>;

class OnDemandTest : public StoreTest {
 protected:
  void SetUp() override {
    StoreTest::SetUp();
    name_ = path("a.engram");
    MapFile file = MapFile::create(name_, sampleHeader());
    file.commit(map_, map_.takeChanges());
  }

  MapFile read() const { return MapFile::open(name_, Access::kReadOnly); }
  MapFile write() const { return MapFile::open(name_, Access::kReadWrite); }

  void sql(const std::string& statements) const {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(name_.c_str(), &database), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(database, statements.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
    sqlite3_close(database);
  }

  /// The rows of a kind that hold good in the file as it is.
  Rows kept(DerivedKind kind) const {
    Rows rows;
    MapFile file = read();
    file.loadOnDemand().content().derived->read(
        kind, [&](std::uint32_t id, auto data) { rows[id].assign(data.begin(), data.end()); });
    return rows;
  }

  using Counts = std::pair<std::uint64_t, std::uint64_t>;  // long-term, short-term
  Counts counts() const {
    const FeatureCounts counts = read().featureCounts();
    return {counts.longTerm, counts.shortTerm};
  }
  static Counts expectedCounts(const map::TopologicalMap& map) {
    Counts counts{0, 0};
    for (const auto& [id, place] : map.places()) {
      counts.first += place.memory->longTerm().size();
      counts.second += place.memory->states.size() - place.memory->longTerm().size();
    }
    return counts;
  }

  map::TopologicalMap map_ = ringMap(5);
  std::string name_;
};

TEST_F(OnDemandTest, GivesTheSameMap) {
  map::TopologicalMap read = MapFile::open(name_, Access::kReadOnly).loadOnDemand();  // outlives its file
  for (const auto& [id, place] : read.places()) EXPECT_FALSE(place.memory.isHere());
  EXPECT_EQ(read.place(map::PlaceId(3)).memory->states, map_.place(map::PlaceId(3)).memory->states);
  EXPECT_TRUE(read.place(map::PlaceId(3)).memory.isHere());
  EXPECT_FALSE(read.place(map::PlaceId(2)).memory.isHere());
  EXPECT_EQ(read.place(map::PlaceId(2)).memory.read().states, map_.place(map::PlaceId(2)).memory->states);
  EXPECT_FALSE(read.place(map::PlaceId(2)).memory.isHere());
  EXPECT_EQ(text({}, read.content()), text({}, map_.content()));
}

TEST_F(OnDemandTest, GivesTheGraphAlone) {
  MapFile file = read();
  const map::TopologicalMap graph = file.loadGraph();
  EXPECT_EQ(graph.edges().size(), map_.edges().size());
  EXPECT_EQ(graph.path().size(), map_.path().size());
  EXPECT_TRUE(graph.views().empty());
  EXPECT_EQ(file.viewCount(), map_.views().size());
  EXPECT_FALSE(graph.place(map::PlaceId(0)).memory.isHere());
}

TEST_F(OnDemandTest, ChecksAMemoryWhenItIsRead) {
  sql("UPDATE memories SET data = zeroblob(100) WHERE id = 2");
  {
    const map::TopologicalMap map = read().loadOnDemand();
    EXPECT_GT(map.place(map::PlaceId(1)).memory->states.size(), 0u);
    for (int again = 0; again < 2; ++again)
      EXPECT_THAT(messageOf([&] { *map.place(map::PlaceId(2)).memory; }),
                  HasSubstr("is damaged: memory of place 2: its checksum is wrong"));
  }
  sql("DELETE FROM memories WHERE id = 2");
  EXPECT_THAT(messageOf([&] { MapFile::open(name_, Access::kReadOnly).loadOnDemand(); }),
              HasSubstr("4 rows of the kind 'memory of place' where 5 were written"));
}

TEST_F(OnDemandTest, AWriterChangesWhatItHasNotRead) {
  {
    MapFile file = write();
    map::TopologicalMap map = file.loadOnDemand();
    base::Rng rng(3);
    map::Place place;
    place.memory = randomMemory(rng, 6, 2);
    map.addPlace(place);
    map_.addPlace(place);
    for (map::TopologicalMap* changed : {&map, &map_}) {
      changed->measure(map::PlaceId(1), std::vector<std::pair<int, float>>{{0, 2.5f}});
      changed->removePlace(map::PlaceId(4), map::PlaceId(0));
    }
    file.commit(map, map.takeChanges());
    EXPECT_FALSE(map.place(map::PlaceId(2)).memory.isHere());
    file.close();
    // After that the rows are read from the closed file.
    EXPECT_EQ(text({}, map.content()), text({}, map_.content()));
  }
  EXPECT_EQ(text({}, read().load().content()), text({}, map_.content()));
}

TEST_F(OnDemandTest, AClosedFileThatOthersHaveWrittenIsNotReadOn) {
  MapFile file = write();
  map::TopologicalMap map = file.loadOnDemand();
  map.survey(map::PlaceId(0), Eigen::Isometry3d::Identity());
  file.commit(map, map.takeChanges());
  file.close();
  MapFile other = write();
  map::TopologicalMap changed = other.load();
  changed.survey(map::PlaceId(1), Eigen::Isometry3d::Identity());
  other.commit(changed, changed.takeChanges());
  EXPECT_THAT(messageOf([&] { *map.place(map::PlaceId(2)).memory; }), HasSubstr("by another program"));
}

/// A reader keeps its snapshot, and a writer waits for no more than one image of it.
TEST_F(OnDemandTest, AReaderYieldsToAWriter) {
  MapFile file = read();
  const map::TopologicalMap map = file.loadOnDemand();
  const std::string before = text({}, map_.content());
  file.yieldToWriter();
  EXPECT_FALSE(map.place(map::PlaceId(0)).memory.isHere());
  std::thread writes([&] {
    MapFile writer = write();
    map::TopologicalMap changed = writer.loadOnDemand();
    changed.measure(map::PlaceId(1), std::vector<std::pair<int, float>>{{0, 2.5f}});
    changed.removePlace(map::PlaceId(4), map::PlaceId(0));
    writer.commit(changed, changed.takeChanges());
  });
  while (read().load().places().size() == 5) {
    file.yieldToWriter();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  writes.join();
  EXPECT_EQ(text({}, map.content()), before);
}

TEST_F(OnDemandTest, KeepsRowsBesideTheMap) {
  const std::string before = text({}, read().load().content());
  write().keep(std::vector<map::DerivedRow>{{DerivedKind::kWords, 0, {1, 2, 3}},
                                            {DerivedKind::kPlaceWords, 1, {4}},
                                            {DerivedKind::kPlaceWords, 3, {}},
                                            {DerivedKind::kPlaceWords, 77, {5}},  // no such place
                                            {DerivedKind::kSignature, 2, Bytes(5000, 6)}});
  EXPECT_EQ(kept(DerivedKind::kWords), (Rows{{0, {1, 2, 3}}}));
  EXPECT_EQ(kept(DerivedKind::kPlaceWords), (Rows{{1, {4}}, {3, {}}}));
  EXPECT_EQ(kept(DerivedKind::kSignature), (Rows{{2, Bytes(5000, 6)}}));
  EXPECT_EQ(text({}, read().load().content()), before) << "they are no part of the map";
  EXPECT_THAT(read().check(), IsEmpty());
  EXPECT_EQ(counts(), expectedCounts(map_));
  write().keep(std::vector<map::DerivedRow>{{DerivedKind::kPlaceWords, 1, {9}}});
  EXPECT_EQ(kept(DerivedKind::kPlaceWords), (Rows{{1, {9}}, {3, {}}}));
}

/// Whoever changes a memory need not know of what was made of it.
TEST_F(OnDemandTest, RowsFallWithWhatTheyAreMadeOf) {
  std::vector<map::DerivedRow> rows;
  for (std::uint32_t i = 0; i < 5; ++i) {
    rows.push_back({DerivedKind::kPlaceWords, i, {1}});
    rows.push_back({DerivedKind::kSignature, i, {2}});
  }
  write().keep(rows);
  {
    MapFile file = write();
    map::TopologicalMap map = file.load();
    map.measure(map::PlaceId(1), std::vector<std::pair<int, float>>{{0, 2.5f}});
    map.setPose(map::PlaceId(2), engram::testing::planarPose(1, 2, 3));
    map.removePlace(map::PlaceId(4), map::PlaceId(0));
    file.commit(map, map.takeChanges());
    file.close();
    EXPECT_EQ(counts(), expectedCounts(map));
  }
  EXPECT_EQ(kept(DerivedKind::kPlaceWords), (Rows{{0, {1}}, {2, {1}}, {3, {1}}}));
  EXPECT_EQ(kept(DerivedKind::kSignature), (Rows{{0, {2}}, {1, {2}}, {2, {2}}, {3, {2}}}));
  EXPECT_THAT(read().check(), IsEmpty()) << "outdated is not damaged";
  sql("UPDATE derived SET data = (SELECT data FROM derived WHERE kind = 73 AND id = 3) WHERE kind = 73 AND "
      "id = 0");
  EXPECT_EQ(kept(DerivedKind::kPlaceWords), (Rows{{2, {1}}, {3, {1}}}));
  EXPECT_THAT(read().check(), ::testing::ElementsAre(HasSubstr("derived row 73 0: its checksum is wrong")));
  sql("UPDATE derived SET data = zeroblob(20) WHERE kind = 78");
  EXPECT_EQ(counts(), expectedCounts(read().load())) << "they are counted anew";
  EXPECT_EQ(read().check().size(), 2u);
}

}  // namespace
}  // namespace engram::store
