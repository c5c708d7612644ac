// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Messages name the true cause: which code of SQLite says what, and maps without their log.
#include "../../libs/store/src/diagnosis.h"
#include "engram/store/map_copy.h"
#include "sample_map.h"
#include "store_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <csignal>
#include <sys/wait.h>
#include <unistd.h>

namespace engram::store {
namespace {

using engram::testing::ringMap;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
namespace fs = std::filesystem;

class MessagesTest : public StoreTest {
 protected:
  /// Commits `images` and dies, `folded` of them in a run before that ended well; then only the main file is
  /// copied.
  void copyWithoutLog(int images, int folded = 0) const {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      auto map = ringMap(4);
      const auto report = sampleReport();
      MapFile file = MapFile::create(path("a.engram"), sampleHeader());
      for (int k = 0; k < images; ++k) {
        if (k > 0 && k == folded) {
          file.close();
          file = MapFile::open(path("a.engram"), Access::kReadWrite);
        }
        file.commit(map, map.takeChanges(), &report);
      }
      kill(getpid(), SIGKILL);
    }
    waitpid(child, nullptr, 0);
    fs::copy_file(path("a.engram"), path("b.engram"), fs::copy_options::overwrite_existing);
  }
};

TEST_F(MessagesTest, EveryCodeHasItsOwnCauseAndOnlyDamageIsCalledDamage) {
  const std::pair<int, const char*> causes[] = {{SQLITE_FULL, "disk is full"},
                                                {SQLITE_IOERR_WRITE, "cannot be read or written"},
                                                {SQLITE_IOERR_NOMEM, "memory of this machine"},
                                                {SQLITE_NOMEM, "memory of this machine"},
                                                {SQLITE_CONSTRAINT_PRIMARYKEY, "fault of this program"},
                                                {SQLITE_TOOBIG, "larger than a map may hold"},
                                                {SQLITE_INTERRUPT, "interrupted"},
                                                {SQLITE_PROTOCOL, "cannot lock files"},
                                                {SQLITE_READONLY, "read-only"},
                                                {SQLITE_CANTOPEN, "cannot be opened"},
                                                {SQLITE_BUSY, "another program"},
                                                {SQLITE_NOTADB, "not an Engram map"},
                                                {SQLITE_MISUSE, "code 21"}};
  for (const auto& [code, cause] : causes) {
    const std::string message = explanation(code, 0, path("none"));
    EXPECT_THAT(message, HasSubstr(cause)) << code;
    EXPECT_THAT(message, AllOf(Not(HasSubstr("damaged")), Not(HasSubstr("build the map again")))) << code;
  }
  EXPECT_THAT(explanation(SQLITE_CORRUPT, 0, path("none")),
              AllOf(HasSubstr("is damaged"), HasSubstr("engram-map recover")));
  EXPECT_THAT(explanation(SQLITE_CANTOPEN, EACCES, path("none")), HasSubstr("you may not read it"));
}

/// The map opens, but is older than it was.
TEST_F(MessagesTest, ACopyWithoutItsLogIsReported) {
  copyWithoutLog(8, 5);
  const std::string name = path("b.engram"), before = fileBytes(name);
  for (int twice = 0; twice < 2; ++twice) {  // opening must not hide it
    EXPECT_THAT(missingLog(name), AllOf(HasSubstr("last images may be missing"), HasSubstr(name + "-wal")));
    const MapFile file = MapFile::open(name, Access::kReadOnly);
    EXPECT_THAT(file.check(), IsEmpty());
    EXPECT_EQ(file.records().size(), 5u);
    EXPECT_EQ(fileBytes(name), before);
    EXPECT_FALSE(fs::exists(name + "-wal"));
  }
  fs::create_symlink(path("a.engram"), path("link"));
  for (const char* whole : {"a.engram", "link"})  // the log is beside what a link leads to
    EXPECT_THAT(missingLog(path(whole)), IsEmpty());
  fs::copy_file(path("a.engram-wal"), name + "-wal");
  EXPECT_THAT(missingLog(name), IsEmpty());
  EXPECT_EQ(MapFile::open(name, Access::kReadOnly).records().size(), 8u);
  EXPECT_THAT(missingLog(path("none")), IsEmpty());
  writeBytes(path("text"), std::string(200, 'x'));
  EXPECT_THAT(missingLog(path("text")), IsEmpty());
}

/// As Engram made maps before format 2: the tables themselves were in the log first.
TEST_F(MessagesTest, AFileWhoseContentIsAllInTheLostLog) {
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(path("a.engram").c_str(), &db), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(db, "PRAGMA journal_mode = WAL; CREATE TABLE places (id INTEGER PRIMARY KEY)",
                         nullptr, nullptr, nullptr),
            SQLITE_OK);
  fs::copy_file(path("a.engram"), path("b.engram"));
  sqlite3_close(db);
  const std::string name = path("b.engram");
  EXPECT_THAT(messageOf([&] { MapFile::open(name, Access::kReadOnly); }),
              AllOf(HasSubstr("copied without its log"), HasSubstr(name + "-wal"), Not(HasSubstr("not an"))));
  writeBytes(name, "");
  EXPECT_THAT(messageOf([&] { MapFile::open(name, Access::kReadOnly); }),
              AllOf(HasSubstr("is empty"), HasSubstr("copied without its log")));
}

TEST_F(MessagesTest, AFileThatIsCutShortSaysSo) {
  auto map = ringMap(4);
  MapFile::create(path("a.engram"), sampleHeader()).commit(map, map.takeChanges());
  const std::string whole = fileBytes(path("a.engram"));
  writeBytes(path("a.engram"), whole.substr(0, whole.size() / 2));
  EXPECT_THAT(messageOf([&] { MapFile::open(path("a.engram"), Access::kReadOnly).load(); }),
              AllOf(HasSubstr("cut short"), HasSubstr(std::to_string(whole.size())),
                    HasSubstr("engram-map recover")));
}

TEST_F(MessagesTest, AMapThatHasJustCrashedMayBeOverwritten) {
  copyWithoutLog(1);
  for (const char* name : {"a.engram", "b.engram"}) {  // with its log and without
    EXPECT_THAT(messageOf([&] { MapFile::create(path(name), sampleHeader()); }), HasSubstr("exists already"));
    EXPECT_EQ(messageOf([&] { MapFile::create(path(name), sampleHeader(), true); }), "no base::Error");
    EXPECT_EQ(MapFile::open(path(name), Access::kReadOnly).load().places().size(), 0u);
  }
  sqlite3* db = nullptr;  // another program's database is still safe, also with all of it in its log
  const std::string other = path("other");
  ASSERT_EQ(sqlite3_open(other.c_str(), &db), SQLITE_OK);
  sqlite3_exec(db, "PRAGMA journal_mode = WAL; CREATE TABLE t (x)", nullptr, nullptr, nullptr);
  EXPECT_THAT(messageOf([&] { MapFile::create(other, sampleHeader(), true); }),
              HasSubstr("not an Engram map"));
  sqlite3_close(db);
}

}  // namespace
}  // namespace engram::store
