// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// Maps with right checksums that someone else made: nothing in them is run, nothing of them is believed.
#include "codec.h"
#include "engram/store/map_file.h"
#include "engram/store/report_json.h"
#include "sample_map.h"
#include "store_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <functional>
#include <limits>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace engram::store {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

rlim_t addressSpace() {
  std::ifstream statm("/proc/self/statm");
  rlim_t pages = 0;
  statm >> pages;
  return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

/// What f() returns in a child that may take 400 MB and 20 s more, or the signal that ended it.
std::string inChild(const std::function<std::string()>& f) {
  int ends[2];
  if (pipe(ends) != 0) return "no pipe";
  const pid_t child = fork();
  if (child == 0) {
    const rlim_t memory = addressSpace() + (400u << 20);
    const rlimit space{memory, memory}, time{20, 20}, core{0, 0};
    setrlimit(RLIMIT_AS, &space);
    setrlimit(RLIMIT_CPU, &time);
    setrlimit(RLIMIT_CORE, &core);
    std::string result;
    try {
      result = f();
    } catch (const std::exception& e) {
      result = std::string("thrown: ") + e.what();
    }
    const auto written = write(ends[1], result.data(), std::min<std::size_t>(result.size(), 4000));
    _exit(written >= 0 ? 0 : 1);
  }
  close(ends[1]);
  std::string result(4096, '\0');
  const auto size = read(ends[0], result.data(), result.size());
  close(ends[0]);
  result.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? "killed by signal " + std::to_string(WTERMSIG(status)) : result;
}

class HostileMapTest : public StoreTest {
 protected:
  void SetUp() override {
    StoreTest::SetUp();
    name_ = path("a.engram");
    auto map = engram::testing::ringMap(3, 6);
    const auto report = sampleReport();
    MapFile::create(name_, sampleHeader()).commit(map, map.takeChanges(), &report);
    good_ = fileBytes(name_);
  }

  void sql(const std::string& statements, const Blob* blob = nullptr) const {
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(name_.c_str(), &db), SQLITE_OK);
    if (blob == nullptr) {
      ASSERT_EQ(sqlite3_exec(db, statements.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
          << sqlite3_errmsg(db) << ": " << statements;
    } else {
      sqlite3_stmt* statement = nullptr;
      ASSERT_EQ(sqlite3_prepare_v2(db, statements.c_str(), -1, &statement, nullptr), SQLITE_OK);
      sqlite3_bind_blob64(statement, 1, blob->data(), blob->size(), SQLITE_STATIC);
      EXPECT_EQ(sqlite3_step(statement), SQLITE_DONE);
      sqlite3_finalize(statement);
    }
    sqlite3_close(db);
  }
  void put(const std::string& table, std::uint64_t id, const Blob& row) const {
    sql("UPDATE " + table + " SET data = ?1 WHERE id = " + std::to_string(id), &row);
  }
  void putHeader(const std::string& key, const std::string& value) const {
    sql("UPDATE header SET value = '" + value + "', crc = " + std::to_string(crc32Of(key + '\n' + value)) +
        " WHERE key = '" + key + "'");
  }
  void putRecord(const std::string& json) const {
    const Blob text(json.begin(), json.end());
    sql("UPDATE records SET json = CAST(?1 AS TEXT), crc = " + std::to_string(crc32Of(json)), &text);
  }
  void restore() const { writeBytes(name_, good_); }

  /// What check() finds, line by line, or why the file cannot be opened.
  std::string verdict() const {
    return inChild([this] {
      std::string all;
      for (const auto& problem : MapFile::open(name_, Access::kReadOnly).check()) all += problem + '\n';
      return all.empty() ? "sound" : all;
    });
  }
  /// Why a program that extends the map refuses it.
  std::string whyNotExtended() const {
    return inChild([this] {
      MapFile::open(name_, Access::kReadWrite).load();
      return std::string("extended");
    });
  }

  std::string name_, good_;
};

TEST_F(HostileMapTest, TheOneOfTheTestIsSound) {
  EXPECT_EQ(verdict(), "sound");
  EXPECT_EQ(whyNotExtended(), "extended");
}

TEST_F(HostileMapTest, NothingOfAForeignSchemaIsRun) {
  const std::pair<const char*, const char*> cases[] = {
      {"CREATE TRIGGER t AFTER INSERT ON records BEGIN DELETE FROM places; END", "it holds the trigger 't'"},
      {"CREATE VIEW v AS SELECT 1", "it holds the view 'v'"},
      // Counts for ever as soon as a place is read.
      {"ALTER TABLE places RENAME TO p;"
       "CREATE VIEW places AS SELECT id, data FROM p WHERE 0 < (WITH RECURSIVE c(x) AS "
       "(SELECT 1 UNION ALL SELECT x + 1 FROM c) SELECT count(*) FROM c)",
       "it holds the"},
      {"CREATE INDEX i ON records (json)", "it holds the index 'i'"},
      {"CREATE TABLE more (x)", "it holds the table 'more'"},
      {"ANALYZE", "it holds the table 'sqlite_stat1'"},
      {"CREATE VIRTUAL TABLE f USING fts5(x)", "it holds the table 'f'"},
      {"ALTER TABLE views ADD COLUMN g AS (hex(zeroblob(99999999)))", "table 'views' has other columns"},
      {"DROP TABLE edges", "table 'edges' is missing"},
      {"CREATE TABLE \"\x1b[2J\" (x)", "it holds the table '\\x1b[2J'"}};
  for (const auto& [statements, message] : cases) {
    restore();
    sql(statements);
    const std::string before = fileBytes(name_);
    EXPECT_THAT(verdict(), HasSubstr(message)) << statements;
    EXPECT_THAT(whyNotExtended(), HasSubstr(message)) << statements;
    EXPECT_EQ(fileBytes(name_), before) << statements;
  }
}

TEST_F(HostileMapTest, TwoTablesDoNotShareTheirPages) {
  sql("PRAGMA writable_schema = ON; UPDATE sqlite_master SET rootpage = (SELECT rootpage FROM sqlite_master "
      "WHERE name = 'views') WHERE name = 'path'");
  EXPECT_THAT(whyNotExtended(), HasSubstr("damaged"));
}

/// Each history is shorter than the row; together they are 4 GB of a row of 30 KB.
TEST_F(HostileMapTest, HistoriesTakeNoMoreThanTheRowHolds) {
  constexpr std::uint32_t kFeatures = 20000;
  constexpr std::size_t kLength = 200000;
  BlobWriter row(RowKind::kMemory, 1);
  row.varint(kFeatures);
  row.put(std::uint32_t{1});
  row.put(kFeatures);
  const std::vector<std::uint8_t> zeros(12 * kFeatures + 3 * kLength);
  row.raw(zeros.data(), 12 * kFeatures);  // ids, values, ages, stages, counters
  for (std::uint32_t i = 0; i < kFeatures; ++i) row.varint(kLength);
  row.raw(zeros.data(), zeros.size());
  row.compress();
  put("memories", 0, std::move(row).seal(0));
  EXPECT_THAT(verdict(), HasSubstr("memory of place 0: a row is too short"));
}

TEST_F(HostileMapTest, RecordsAreNotNestedWithoutEnd) {
  const auto times = [](int n, const std::string& text) {
    std::string all;
    for (int i = 0; i < n; ++i) all += text;
    return all;
  };
  constexpr int kDeep = 200000;
  for (const std::string& json :
       {R"({"hypotheses":)" + times(kDeep, "[") + times(kDeep, "]") + "}",
        R"({"memory":)" + times(kDeep, R"({"a":)") + "1" + times(kDeep, "}") + "}", times(kDeep, "[")}) {
    putRecord(json);
    EXPECT_THAT(verdict(), HasSubstr("record 0: its JSON is nested more than 64 deep"));
  }
  // Brackets within text nest nothing.
  types::FrameReport report;
  report.label = times(1000, "[{\\\"");
  EXPECT_EQ(reportFromJson(toJson(report)).label, report.label);
}

TEST_F(HostileMapTest, NumbersOfRowsHaveRoomAndFit) {
  MapState state = decodeState(encode(MapState{}));
  state = {.commits = 1,
           .nextPlace = 3,
           .nextView = 3,
           .nextEdge = 3,
           .places = 3,
           .views = 3,
           .edges = 3,
           .path = 3,
           .records = 1,
           .redetections = {}};
  put("state", 0, encode(state));
  ASSERT_EQ(verdict(), "sound");
  const auto with = [&](auto&& change) {
    MapState other = state;
    change(other);
    put("state", 0, encode(other));
    return whyNotExtended();
  };
  const std::string full = "the row of totals: it leaves no numbers for new rows";
  EXPECT_THAT(with([](MapState& s) { s.nextPlace = 0xfffffffe; }), HasSubstr(full));
  EXPECT_THAT(with([](MapState& s) { s.nextView = 0xffffffff; }), HasSubstr(full));
  EXPECT_THAT(with([](MapState& s) { s.nextEdge = 0xfffffff0; }), HasSubstr(full));
  EXPECT_THAT(with([](MapState& s) { s.records = std::uint64_t{1} << 63; }), HasSubstr(full));
  EXPECT_THAT(with([](MapState& s) { s.nextEdge = 2; }), HasSubstr("more rows than numbers"));
  EXPECT_THAT(with([](MapState& s) { s.records = 0; }), HasSubstr("record 0 is the last one where 0"));
  EXPECT_THAT(with([](MapState& s) { s.records = 7; }), HasSubstr("record 0 is the last one where 7"));
  EXPECT_THAT(with([](MapState& s) {
                s.redetections.views = 1;
                s.redetections.byAge[0].trials = std::numeric_limits<std::uint64_t>::max();
              }),
              HasSubstr("counts of features seen again are out of range"));
}

TEST_F(HostileMapTest, HeadersAreBelievedWithinReason) {
  const std::tuple<const char*, const char*, const char*> cases[] = {
      {"descriptor_kind", "77", "of an unknown kind"},
      {"descriptor_kind", "-1", "'descriptor_kind' is out of range"},
      {"descriptor_kind", "1x", "'descriptor_kind' is not a number"},
      {"descriptor_kind", "0", "place 0: its descriptors are not those that the header names"},
      {"descriptor_dim", "-2000000000", "'descriptor_dim' is out of range"},
      {"descriptor_dim", "99999999999999999999", "'descriptor_dim' is out of range"},
      {"descriptor_dim", "0", "dimension of its descriptors is out of range"},
      {"descriptor_dim", "128", "place 0: its descriptors are not those that the header names"},
      {"first_stamp", "nan", "its first time stamp is not finite"},
      {"first_stamp", "", "'first_stamp' is not a number"}};
  for (const auto& [key, value, message] : cases) {
    restore();
    putHeader(key, value);
    EXPECT_THAT(verdict(), HasSubstr(message)) << key << " = " << value;
    EXPECT_THAT(whyNotExtended(), HasSubstr(message)) << key << " = " << value;
  }
  restore();
  sql("INSERT INTO header SELECT * FROM header WHERE key = 'camera'");
  EXPECT_THAT(verdict(), HasSubstr("header 'camera' is there twice"));
}

TEST_F(HostileMapTest, PlacesViewsAndPathHaveNumbersThatMeanSomething) {
  const auto read = MapFile::open(name_, Access::kReadOnly).load();
  const auto place = [&](auto&& change) {
    restore();
    map::Place p = read.place(map::PlaceId(1));
    change(p);
    put("places", 1, encode(p));
    return verdict();
  };
  EXPECT_THAT(place([](map::Place& p) { p.createdStamp = kNaN; }), HasSubstr("place 1: its time stamp"));
  EXPECT_THAT(place([](map::Place& p) { p.session = -1; }), HasSubstr("place 1: its number of the drive"));
  EXPECT_THAT(place([](map::Place& p) { p.session = std::numeric_limits<int>::max(); }),
              HasSubstr("place 1: its number of the drive"));
  EXPECT_THAT(place([](map::Place& p) { p.T_map_place.translation().x() = 1e300; }),
              HasSubstr("place 1: its pose is more than 1e9 m away"));
  EXPECT_THAT(place([](map::Place& p) { p.T_map_place.matrix()(0, 0) += 0.1; }),
              HasSubstr("place 1: its pose is not a finite rigid"));
  EXPECT_THAT(place([](map::Place& p) { p.T_map_place.matrix().row(0) *= -1; }),
              HasSubstr("place 1: its pose"));
  EXPECT_THAT(place([](map::Place& p) { p.T_world_place = engram::testing::planarPose(0, -kInf, 0); }),
              HasSubstr("place 1: its surveyed pose"));
  EXPECT_THAT(place([](map::Place& p) { p.matchedStamp = kInf; }),
              HasSubstr("place 1: the time of its last"));

  const auto view = [&](auto&& change) {
    restore();
    map::View v = read.views().at(map::ViewId(2));
    change(v);
    put("views", 2, encode(v));
    return verdict();
  };
  EXPECT_THAT(view([](map::View& v) { v.stamp = -kInf; }), HasSubstr("view 2: its time stamp"));
  EXPECT_THAT(view([](map::View& v) { v.session = -7; }), HasSubstr("view 2: its number of the drive"));
  EXPECT_THAT(view([](map::View& v) { v.place = map::PlaceId(9); }), HasSubstr("view 2 is of a place"));

  const auto point = [&](auto&& change) {
    restore();
    map::PathPoint p = read.path()[1];
    change(p);
    put("path", 1, encode(p, 1));
    return verdict();
  };
  EXPECT_THAT(point([](map::PathPoint& p) { p.stamp = kNaN; }), HasSubstr("path point 1: its time stamp"));
  EXPECT_THAT(point([](map::PathPoint& p) { p.T_anchor_robot.translation().z() = -2e9; }),
              HasSubstr("path point 1: its pose is more than 1e9 m away"));
  EXPECT_THAT(point([](map::PathPoint& p) { p.anchor = map::PlaceId(9); }),
              HasSubstr("path point 1 is tied"));
}

TEST_F(HostileMapTest, EdgesHaveCovariancesThatCanBeInverted) {
  const auto read = MapFile::open(name_, Access::kReadOnly).load();
  const auto edge = [&](auto&& change) {
    restore();
    map::Edge e = read.edge(map::EdgeId(0));
    change(e);
    put("edges", 0, encode(e));
    return verdict();
  };
  using types::Matrix6d;
  const Matrix6d one = Matrix6d::Identity();
  EXPECT_EQ(edge([&](map::Edge& e) { e.T_a_b.cov = 1e-14 * one; }), "sound");
  EXPECT_THAT(edge([&](map::Edge& e) { e.T_a_b.cov(5, 5) = kNaN; }),
              HasSubstr("edge 0: its covariance is not finite"));
  EXPECT_THAT(edge([&](map::Edge& e) { e.T_a_b.cov = 1e300 * one; }),
              HasSubstr("edge 0: its covariance is too large"));
  EXPECT_THAT(edge([&](map::Edge& e) { e.T_a_b.cov = 1e-300 * one; }),
              HasSubstr("edge 0: its covariance is not pos"));
  EXPECT_THAT(edge([&](map::Edge& e) { e.T_a_b.cov = -one; }),
              HasSubstr("edge 0: its covariance is not pos"));
  EXPECT_THAT(edge([&](map::Edge& e) { e.T_a_b.cov(0, 1) = 0.001; }),
              HasSubstr("edge 0: its covariance is not sym"));
  EXPECT_THAT(edge([&](map::Edge& e) { e.T_a_b.T_a_b.translation().x() = 1e300; }),
              HasSubstr("edge 0: its pose"));
  EXPECT_THAT(edge([&](map::Edge& e) { e.a = map::PlaceId(99); }), HasSubstr("edge 0 ends at a place"));
  EXPECT_THAT(edge([&](map::Edge& e) {
                e.correspondences = {{99, 0}};
              }),
              HasSubstr("edge 0 names a feature"));
}

TEST_F(HostileMapTest, FeaturesAreFinite) {
  const auto read = MapFile::open(name_, Access::kReadOnly).load();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto memory = [&](auto&& change) {
    restore();
    memory::PlaceMemory m = read.place(map::PlaceId(2)).memory;
    change(m);
    put("memories", 2, encodeMemory(map::PlaceId(2), m));
    return verdict();
  };
  using memory::PlaceMemory;
  EXPECT_THAT(memory([&](PlaceMemory& m) { m.features.keypoints[3].y = nan; }),
              HasSubstr("place 2: a keypoint"));
  EXPECT_THAT(memory([&](PlaceMemory& m) { m.features.bearings[3].z() = nan; }),
              HasSubstr("place 2: a bearing"));
  EXPECT_THAT(memory([&](PlaceMemory& m) { m.features.ranges.assign(6, -1.0f); }),
              HasSubstr("place 2: a range"));
  EXPECT_THAT(memory([&](PlaceMemory& m) { m.states[0].value = nan; }), HasSubstr("place 2: the value"));
  EXPECT_THAT(memory([&](PlaceMemory& m) { m.nextFeatureId = 0xffffffff; }),
              HasSubstr("place 2: it has used up"));
  EXPECT_THAT(memory([&](PlaceMemory& m) {
                m.features.descriptors = types::Descriptors(types::DescriptorKind::kInt8, 0);
              }),
              HasSubstr("memory of place 2: its descriptors have no components"));
  EXPECT_THAT(memory([&](PlaceMemory& m) {
                m.features.descriptors = types::Descriptors(types::DescriptorKind::kFloat, 2);
                m.features.descriptors.resize(6);
                const float inf = std::numeric_limits<float>::infinity();
                std::memcpy(m.features.descriptors.mutableRow(5) + 4, &inf, 4);
              }),
              HasSubstr("place 2: a descriptor is not finite"));
}

/// A picture that cannot be shown is no reason to lose the map, but check() says so.
TEST_F(HostileMapTest, PicturesAreWhatTheirHeadersSay) {
  const auto read = MapFile::open(name_, Access::kReadOnly).load();
  const auto picture = [&](const Blob& jpeg) {
    restore();
    map::View v = read.views().at(map::ViewId(0));
    v.jpeg = jpeg;
    put("views", 0, encode(v));
    EXPECT_EQ(whyNotExtended(), "extended");
    return verdict();
  };
  const auto jpeg = [](std::uint8_t high, std::uint8_t low) {
    return Blob{0xff, 0xd8, 0xff, 0xe0, 0,   4,    1,   2, 0xff, 0xff, 0xc0,
                0,    11,   8,    high, low, high, low, 1, 1,    0x11, 0};
  };
  EXPECT_EQ(picture(jpeg(1, 0)), "sound");
  EXPECT_THAT(picture(jpeg(0xff, 0xff)), HasSubstr("view 0: its picture: it has too many pixels"));
  EXPECT_THAT(picture(jpeg(0, 0)), HasSubstr("view 0: its picture: it has no pixels"));
  EXPECT_THAT(picture({1, 2, 3}), HasSubstr("view 0: its picture: it is not a JPEG"));
  EXPECT_THAT(picture({0xff, 0xd8, 0xff, 0xd9, 0, 0, 0, 0, 0, 0, 0}), HasSubstr("its header is damaged"));
  EXPECT_THAT(picture({0xff, 0xd8, 0xff, 0xe0, 0xff, 0xff, 0, 0, 0, 0, 0}),
              HasSubstr("its header is damaged"));
}

TEST_F(HostileMapTest, RecordsStandInTheirOrderAndHaveTimes) {
  putRecord(R"({"stamp":null})");
  EXPECT_THAT(verdict(), HasSubstr("record 0: its time stamp is not finite"));
  restore();
  sql("UPDATE records SET id = 5");
  EXPECT_THAT(verdict(), HasSubstr("record 5: the one before it is missing"));
}

/// Numbers that are cut when they are stored would make two rows of one.
TEST(HostileRows, NumbersAreNotCut) {
  const auto edge = [](std::uint64_t feature, std::uint8_t scale) {
    BlobWriter row(RowKind::kEdge, 1);
    const std::vector<std::uint8_t> zeros(9 + 12 * 8 + 36 * 8);
    row.raw(zeros.data(), zeros.size());
    row.put(scale);
    row.varint(1);
    row.varint(feature);
    row.varint(0);
    return std::move(row).seal(0);
  };
  EXPECT_EQ(decodeEdge(edge(7, 1), 0).correspondences.front().first, 7u);
  EXPECT_THAT(messageOf([&] { decodeEdge(edge(7 + (std::uint64_t{1} << 32), 1), 0); }),
              HasSubstr("too large"));
  EXPECT_THAT(messageOf([&] { decodeEdge(edge(7, 2), 0); }), HasSubstr("neither"));
  BlobWriter row(RowKind::kEdge, 1);
  for (int i = 0; i < 9; ++i) row.put(std::uint8_t{0x80});
  row.put(std::uint8_t{2});  // 2^64
  const Blob sealed = std::move(row).seal(0);
  BlobReader reader(sealed, RowKind::kEdge, 1, 0);
  EXPECT_THAT(messageOf([&] { reader.varint(); }), HasSubstr("too large"));
}

}  // namespace
}  // namespace engram::store
