// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Drives: what they are told apart by, taken back by and resumed by, and what is forgotten of old ones.
#include "engram/store/drive_writer.h"
#include "sample_map.h"
#include "store_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

namespace engram::store {
namespace {

using engram::testing::planarPose;
using engram::testing::ringMap;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

types::Frame frameOf(int drive, int image, double stamp) {
  types::Frame frame;
  frame.index = static_cast<std::uint64_t>(image);
  frame.stamp = stamp;
  frame.image = cv::Mat(4, 4, CV_8UC1, cv::Scalar(10 * drive + image));
  return frame;
}

/// Stands for a pipeline: each image changes something else in the map, and the same image the same.
types::FrameReport learn(map::TopologicalMap& map, const types::Frame& frame, int session) {
  const auto n = static_cast<std::uint32_t>(frame.index);
  const auto first = map.places().begin()->first, last = map.places().rbegin()->first;
  switch (n % 6) {
    case 0: {
      map::Place place;
      place.session = session;
      place.T_map_place = planarPose(n, 2, 0.1);
      const auto made = map.addPlace(place);
      map.addView({.place = made, .label = "v" + std::to_string(n), .session = session});
      map.addEdge({.a = last, .b = made, .T_a_b = engram::testing::relPose(planarPose(1, 0, 0))});
      break;
    }
    case 1:
      map.setPose(first, planarPose(n, n, n));
      break;
    case 2:
      map.removeEdge(map.edges().begin()->first);
      break;
    case 3:
      map.setStanding(last, map::Standing::kUnmatched, frame.stamp);
      break;
    case 4:
      if (map.places().size() > 4) map.removePlace(first, last);
      break;
    default:
      map.survey(last, planarPose(1, n, 0));
  }
  map.addPathPoint({session, frame.stamp, map.places().rbegin()->first, planarPose(0.1 * n, 0, 0)});
  types::FrameReport report = sampleReport();
  report.index = frame.index;
  report.stamp = frame.stamp;
  return report;
}

class DriveTest : public StoreTest {
 protected:
  /// Maps the images of a drive, up to `until`; without an end when `killed`.
  void drive(const std::string& name, int number, const DriveOptions& options, int until, bool killed = false,
             double firstStamp = 1000) {
    const auto first = frameOf(number, 0, firstStamp);
    DriveWriter writer(name, options, std::to_string(number) + ".rawlog", &first);
    if (writer.complete()) return;
    map::TopologicalMap map = writer.load();
    const int session = map.nextSession();
    if (map.empty()) map = ringMap(6);
    for (int k = 0; k < until; ++k) {
      const auto frame = frameOf(number, k, firstStamp + k);
      if (k == 0) writer.begin(frame, session, sampleHeader());
      const auto report = learn(map, frame, session);
      writer.add(map, report);
    }
    if (killed) return;
    map.setPose(map.places().begin()->first, planarPose(9, 9, 9));  // the last relaxation
    writer.end(map, until == kImages);
  }

  std::string dumpOf(const std::string& name) const {
    std::ostringstream out;
    const MapFile file = MapFile::open(name, Access::kReadOnly);
    EXPECT_THAT(file.check(), IsEmpty());
    file.dump(out);
    return out.str();
  }

  static constexpr int kImages = 14;
};

TEST_F(DriveTest, ResumedAnywhereTheMapIsThatOfAnUndisturbedRun) {
  for (const bool extended : {false, true}) {
    const DriveOptions options{.extend = extended};
    const auto prepare = [&](const std::string& name) {
      if (extended) drive(name, 1, {}, kImages);
    };
    const std::string whole = path(extended ? "whole2" : "whole1");
    prepare(whole);
    drive(whole, 2, options, kImages);
    for (const int cut : {0, 1, 2, 5, 6, 9, 13, 14})
      for (const bool killed : {true, false}) {
        const std::string name =
            path("cut_" + std::to_string(extended) + std::to_string(cut) + (killed ? "_killed" : "_stopped"));
        prepare(name);
        if (cut > 0) drive(name, 2, options, cut, killed);
        DriveOptions resumed = options;
        resumed.resume = true;
        drive(name, 2, resumed, kImages);
        EXPECT_EQ(dumpOf(name), dumpOf(whole)) << name;
        drive(name, 2, resumed, kImages);  // complete: nothing more to do
        EXPECT_EQ(dumpOf(name), dumpOf(whole)) << name;
      }
  }
}

/// A first run may be killed while it makes the map, or before its first image.
TEST_F(DriveTest, WhatWasCutOffBeforeItsFirstImageBegins) {
  drive(path("whole"), 2, {}, kImages);
  writeBytes(path("empty"), "");
  MapFile::create(path("made"), sampleHeader()).close();
  for (const char* name : {"empty", "made", "none"}) {
    drive(path(name), 2, {.resume = true}, kImages);
    EXPECT_EQ(dumpOf(path(name)), dumpOf(path("whole"))) << name;
  }
  writeBytes(path("letter"), "Dear robot");
  EXPECT_THAT(messageOf([&] { drive(path("letter"), 2, {.resume = true}, kImages); }), HasSubstr("letter"));
  EXPECT_EQ(fileBytes(path("letter")), "Dear robot");
}

/// Killed again while the known images are gone over, or just after.
TEST_F(DriveTest, CanBeResumedMoreThanOnce) {
  drive(path("whole"), 2, {}, kImages);
  for (const int second : {3, 7, 9}) {
    const std::string name = path("twice" + std::to_string(second));
    drive(name, 2, {}, 7, true);
    drive(name, 2, {.resume = true}, second, true);
    EXPECT_EQ(MapFile::open(name, Access::kReadOnly).records().size(),
              std::max<std::size_t>(7, static_cast<std::size_t>(second)));
    drive(name, 2, {.resume = true}, kImages);
    EXPECT_EQ(dumpOf(name), dumpOf(path("whole")));
  }
}

TEST_F(DriveTest, WhatIsNotTheSameDriveIsNotResumed) {
  const std::string name = path("a");
  drive(name, 2, {}, 7, true);
  const std::string before = dumpOf(name);
  EXPECT_THAT(messageOf([&] { drive(name, 3, {.resume = true}, kImages); }),
              AllOf(HasSubstr("nothing to resume"), HasSubstr("2.rawlog"), HasSubstr("--extend")));
  const auto first = frameOf(2, 0, 1000);
  DriveWriter writer(name, {.resume = true}, "2.rawlog", &first);
  auto map = writer.load();
  map = ringMap(6);
  writer.begin(first, 0, sampleHeader());
  auto report = learn(map, first, 0);
  report.outcome = types::Outcome::kRefused;  // as another configuration would
  EXPECT_THAT(messageOf([&] { writer.add(map, report); }), HasSubstr("not what was recorded"));
  EXPECT_EQ(dumpOf(name), before);
}

TEST_F(DriveTest, ADriveIsLearntTwiceOnlyWhenAsked) {
  const std::string name = path("a");
  drive(name, 1, {}, kImages);
  drive(name, 2, {.extend = true}, 5);  // stopped
  EXPECT_THAT(messageOf([&] { drive(name, 1, {.extend = true}, kImages); }),
              AllOf(HasSubstr("learnt '1.rawlog' already"), HasSubstr("drive 0"), HasSubstr("--again")));
  EXPECT_THAT(messageOf([&] { drive(name, 2, {.extend = true}, kImages); }), HasSubstr("--resume"));
  drive(name, 1, {.extend = true, .again = true}, kImages);
  const auto drives = MapFile::open(name, Access::kReadOnly).drives();
  ASSERT_EQ(drives.size(), 3u);
  EXPECT_TRUE(drives[0].finished);
  EXPECT_FALSE(drives[1].finished);
  EXPECT_EQ(drives[1].images, 5u);
  EXPECT_EQ(drives[2].firstRecord, kImages + 5u);
}

/// By number, not by time: the second drive is the first by its stamps, and in the third the clock goes back
/// a day after a few images.
TEST_F(DriveTest, RecordsOfOldDrivesAreForgottenWhateverTheClockSays) {
  const std::string name = path("a");
  drive(name, 1, {}, kImages, false, 5000);
  drive(name, 2, {.extend = true}, kImages, false, 1000);
  drive(name, 3, {.extend = true}, kImages, false, -86400);
  drive(name, 4, {.extend = true}, kImages, false, 9000);
  for (const int firstKept : {1, 3}) {
    {
      const auto first = frameOf(4, 0, 9000);
      DriveWriter writer(name, {.extend = true}, "5.rawlog", &first);
      auto map = writer.load();
      map.forgetPath(firstKept);
      writer.forget(map, firstKept);
    }
    const MapFile file = MapFile::open(name, Access::kReadOnly);
    EXPECT_THAT(file.check(), IsEmpty());
    const auto drives = file.drives();
    ASSERT_EQ(drives.size(), 4u);
    const auto kept =
        std::find_if(drives.begin(), drives.end(), [&](const Drive& d) { return d.session >= firstKept; });
    ASSERT_NE(kept, drives.end());
    const auto records = file.records();
    EXPECT_EQ(records.size(), static_cast<std::size_t>(drives.end() - kept) * kImages);
    EXPECT_EQ(records.front().stamp, kept->firstStamp);
    const auto map = file.load();
    for (const auto& point : map.path()) EXPECT_GE(point.session, firstKept);
  }
  drive(name, 6, {.extend = true}, kImages);  // numbers go on behind those that were forgotten
  EXPECT_THAT(MapFile::open(name, Access::kReadOnly).check(), IsEmpty());
}

/// Maps of version 1 did not name their drives.
TEST_F(DriveTest, MapsOfTheFirstVersionAreBroughtUpWhenTheyAreWritten) {
  const std::string name = path("a");
  drive(name, 1, {}, kImages, false, 5000);
  drive(name, 2, {.extend = true}, kImages, false, 1000);
  const auto known = MapFile::open(name, Access::kReadOnly).drives();
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(name.c_str(), &db), SQLITE_OK);
  ASSERT_EQ(
      sqlite3_exec(db, "DROP TABLE drives; DROP TABLE undo; DROP TABLE derived; PRAGMA user_version = 1",
                   nullptr, nullptr, nullptr),
      SQLITE_OK);
  sqlite3_close(db);
  EXPECT_THAT(MapFile::open(name, Access::kReadOnly).check(), IsEmpty());
  EXPECT_THAT(MapFile::open(name, Access::kReadOnly).drives(), IsEmpty());
  const std::string before = fileBytes(name);
  MapFile::open(name, Access::kReadWrite).close();
  EXPECT_EQ(fileBytes(name), before) << "nothing was written";
  drive(name, 3, {.extend = true}, kImages);
  const MapFile file = MapFile::open(name, Access::kReadOnly);
  EXPECT_THAT(file.check(), IsEmpty());
  const auto drives = file.drives();
  ASSERT_EQ(drives.size(), 3u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(drives[i].session, known[i].session);
    EXPECT_EQ(drives[i].images, known[i].images);
    EXPECT_EQ(drives[i].firstRecord, known[i].firstRecord);
    EXPECT_EQ(drives[i].firstStamp, known[i].firstStamp);
  }
}

/// What is kept to take a drive back goes when the drive is complete.
TEST_F(DriveTest, ACompleteDriveLeavesNothingBehind) {
  const std::string name = path("a");
  drive(name, 1, {}, kImages);
  drive(name, 2, {.extend = true}, kImages);
  sqlite3* db = nullptr;
  sqlite3_stmt* rows = nullptr;
  ASSERT_EQ(sqlite3_open(name.c_str(), &db), SQLITE_OK);
  const auto number = [&](const char* sql) {
    sqlite3_prepare_v2(db, sql, -1, &rows, nullptr);
    sqlite3_step(rows);
    const auto value = sqlite3_column_int64(rows, 0);
    sqlite3_finalize(rows);
    return value;
  };
  EXPECT_EQ(number("SELECT count(*) FROM undo"), 0);
  EXPECT_EQ(number("PRAGMA freelist_count"), 0);
  sqlite3_close(db);
}

}  // namespace
}  // namespace engram::store
