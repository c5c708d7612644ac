// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/keeper/merge.h"
#include "engram/store/map_copy.h"
#include "engram/store/map_file.h"
#include "postgres_server.h"
#include "program_process.h"
#include "run_fixture.h"
#include "tiny_drive.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <sstream>
#include <thread>

namespace engram::apps {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t kImages = 24;

/// The programs, with their map on a server.
class MapServerTest : public RunTest {
 protected:
  static void SetUpTestSuite() {
    if (engram::testing::PostgresServer::installed())
      server_ = std::make_unique<engram::testing::PostgresServer>();
  }
  static void TearDownTestSuite() { server_.reset(); }
  void SetUp() override {
    RunTest::SetUp();
    if (!server_) {
      ASSERT_EQ(std::getenv("CI"), nullptr) << "PostgreSQL is not installed: scripts/setup.sh does it";
      GTEST_SKIP() << "no PostgreSQL 15 here: apt-get install postgresql";
    }
    ASSERT_TRUE(server_->started());
    writeRawlog(path("1.rawlog"), firstFrames(kImages));
    before_ = std::filesystem::current_path();
    std::filesystem::current_path(folder_);  // where a drive goes on without its server
  }
  void TearDown() override {
    if (!before_.empty()) std::filesystem::current_path(before_);
    RunTest::TearDown();
  }
  static std::string map() {
    std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    return server_->map(name);
  }
  static std::string dumpOf(const std::string& map) {
    std::ostringstream out;
    store::MapFile::open(map, store::Access::kReadOnly).dump(out);
    return out.str();
  }
  std::string undisturbed() {
    const RunResult made = slam({config(), "--rawlog", path("1.rawlog"), "--map", path("file.engram"), "-q"});
    EXPECT_EQ(made.code, kOk) << made.err;
    return dumpOf(path("file.engram"));
  }
  pid_t start(std::vector<std::string> more) const {
    std::vector<std::string> words = {"engram-slam", config(), "--rawlog", path("1.rawlog"),
                                      "--map",       map(),    "-q"};
    words.insert(words.end(), more.begin(), more.end());
    return engram::testing::ProgramProcess{words}.start();
  }
  static std::size_t images() {
    try {
      return store::MapFile::open(map(), store::Access::kReadOnly).records().size();
    } catch (const base::Error&) {
      return 0;
    }
  }

  std::filesystem::path before_;
  static std::unique_ptr<engram::testing::PostgresServer> server_;
};

std::unique_ptr<engram::testing::PostgresServer> MapServerTest::server_;

TEST_F(MapServerTest, AMapOnAServerIsThatOfAFile) {
  const RunResult made = slam({config(), "--rawlog", path("1.rawlog"), "--map", map(), "-q"});
  ASSERT_EQ(made.code, kOk) << made.err;
  EXPECT_EQ(dumpOf(map()), undisturbed());
  const RunResult again = slam({config(), "--rawlog", path("1.rawlog"), "--map", map(), "-q"});
  EXPECT_EQ(again.code, kError);
  EXPECT_THAT(again.err, HasSubstr("exists"));
  // Places learn while localising, on either.
  for (const std::string& m : {map(), path("file.engram")}) {
    const RunResult run = localize({"--map", m, "--rawlog", path("1.rawlog"), "--adapt", "--again", "--out",
                                    path("o.csv"), "--overwrite", "-q"});
    EXPECT_EQ(run.code, kOk) << run.err;
  }
  EXPECT_EQ(dumpOf(map()), dumpOf(path("file.engram")));
  const RunResult frozen =
      localize({"--map", map(), "--rawlog", path("1.rawlog"), "--out", path("f.csv"), "-q"});
  EXPECT_EQ(frozen.code, kOk) << frozen.err;
}

TEST_F(MapServerTest, RobotsThatAreKilledLoseNothing) {
  const std::string whole = undisturbed();
  std::size_t known = 0;
  for (std::size_t until = 5; until < kImages; until += 6) {
    const pid_t robot = start(known == 0 ? std::vector<std::string>{} : std::vector<std::string>{"--resume"});
    for (int status = 0; images() < until && ::waitpid(robot, &status, WNOHANG) == 0;)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    ::kill(robot, SIGKILL);
    ::waitpid(robot, nullptr, 0);
    EXPECT_GE(images(), known);
    known = images();
    EXPECT_THAT(store::MapFile::open(map(), store::Access::kReadOnly).check(), IsEmpty());
  }
  int status = -1;
  ::waitpid(start({"--resume"}), &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(dumpOf(map()), whole);
}

TEST_F(MapServerTest, ADriveGoesOnWithoutItsServerAndComesBack) {
  const std::string whole = undisturbed();
  const pid_t robot = start({});
  while (images() < 8) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  ASSERT_TRUE(server_->stop());
  int status = 0;
  ::waitpid(robot, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), kPartial);
  ASSERT_TRUE(server_->start());
  const std::size_t there = images();
  EXPECT_GE(there, 8u);
  EXPECT_LT(there, kImages);
  // All that the robot knows is in the file.
  const std::string spool = path("engram_adrivegoesonwithoutitsserverandcomesback.spool");
  const store::MapFile file = store::MapFile::open(spool, store::Access::kReadOnly);
  EXPECT_THAT(file.check(), IsEmpty());
  const store::WholeMap alone = store::MapFile::open(path("file.engram"), store::Access::kReadOnly).whole();
  const store::WholeMap spooled = file.whole();
  EXPECT_EQ(spooled.content.places.size(), alone.content.places.size());
  EXPECT_EQ(spooled.content.path.size(), alone.content.path.size());
  EXPECT_GE(there + spooled.records.size(), kImages);
  // Merged, the server has it too.
  store::WholeMap merged = store::MapFile::open(map(), store::Access::kReadOnly).whole();
  const keeper::Merged result = keeper::merge(merged, spooled, map(), spool);
  EXPECT_TRUE(result.joined) << result.reason;
  EXPECT_EQ(merged.content.path.size(), alone.content.path.size());
  EXPECT_GE(merged.records.size(), kImages);
  EXPECT_EQ(merged.content.places.size(), alone.content.places.size());
  // And the drive, whose rawlog is still there, can be finished on the server as if nothing had been.
  ::waitpid(start({"--resume"}), &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(dumpOf(map()), whole);
}

}  // namespace
}  // namespace engram::apps
