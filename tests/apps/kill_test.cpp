// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The real programs, killed at any moment, and several at once on one map. ENGRAM_KILLS, ENGRAM_READERS and
// ENGRAM_WRITERS make it a long run.
#include "engram/base/rng.h"
#include "engram/store/map_file.h"
#include "faulty_vfs.h"
#include "run_fixture.h"
#include "tiny_drive.h"

#include <gmock/gmock.h>
#include <sqlite3.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <spawn.h>
#include <sstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace engram::apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr std::size_t kImages = 16;

int wished(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::atoi(text);
}

/// A program of its own process.
class Child {
 public:
  Child(std::vector<std::string> words, const std::string& outputs) : outputs_(outputs) {
    words.front() = std::string(ENGRAM_BIN_DIR) + "/" + words.front();
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    for (const int fd : {1, 2})
      posix_spawn_file_actions_addopen(&files, fd, (outputs + (fd == 1 ? ".out" : ".err")).c_str(),
                                       O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (posix_spawn(&pid_, argv[0], &files, nullptr, argv.data(), environ) != 0) pid_ = -1;
    posix_spawn_file_actions_destroy(&files);
    EXPECT_GT(pid_, 0) << argv[0];
  }
  ~Child() {
    if (pid_ > 0 && running()) kill(pid_, SIGKILL), wait();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  pid_t pid() const { return pid_; }
  bool running() {
    if (!ended_) ended_ = waitpid(pid_, &status_, WNOHANG) == pid_;
    return !ended_;
  }
  /// The exit code; minus the signal that ended it.
  int wait() {
    if (!ended_) waitpid(pid_, &status_, 0);
    ended_ = true;
    return WIFSIGNALED(status_) ? -WTERMSIG(status_) : WEXITSTATUS(status_);
  }
  int killNow() {
    kill(pid_, SIGKILL);
    return wait();
  }
  std::string out() const { return bytesOf(outputs_ + ".out"); }
  std::string err() const { return bytesOf(outputs_ + ".err"); }

 private:
  std::string outputs_;
  pid_t pid_ = -1;
  int status_ = 0;
  bool ended_ = false;
};

/// How many commits another program made to a map, by one statement; none while there is no map.
int imagesIn(const std::string& map) {
  sqlite3* db = nullptr;
  sqlite3_stmt* count = nullptr;
  int images = 0;
  if (fs::exists(map) && sqlite3_open_v2(map.c_str(), &db, SQLITE_OPEN_READONLY, nullptr) == SQLITE_OK &&
      sqlite3_prepare_v2(db, "SELECT COUNT(*) FROM records", -1, &count, nullptr) == SQLITE_OK &&
      sqlite3_step(count) == SQLITE_ROW)
    images = sqlite3_column_int(count, 0);
  sqlite3_finalize(count);
  sqlite3_close(db);
  return images;
}

std::string dumpOf(const std::string& map) {
  std::ostringstream out;
  store::MapFile::open(map, store::Access::kReadOnly).dump(out);
  return out.str();
}

/// How a program is run, and the map that it starts from, if any.
struct Work {
  std::vector<std::string> words;  ///< without the map
  std::string start;
  int imagesBefore = 0;
};

class KillTest : public RunTest {
 protected:
  void SetUp() override {
    RunTest::SetUp();
    const auto some = [](const std::vector<types::Frame>& all) {
      return std::vector<types::Frame>(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(kImages));
    };
    writeRawlog(path("1.rawlog"), some(engram::testing::firstDrive().frames));
    writeRawlog(path("2.rawlog"), some(engram::testing::secondDrive().frames));
    map_ = path("m.engram");
  }

  Work mapping() const { return {{"engram-slam", config(), "--rawlog", path("1.rawlog"), "-q"}, "", 0}; }
  Work extending() {
    return {{"engram-slam", config(), "--rawlog", path("2.rawlog"), "--extend", "-q"}, first(), int{kImages}};
  }
  Work adapting() {
    return {
        {"engram-localize", config(), "--rawlog", path("2.rawlog"), "--adapt", "-q"}, first(), int{kImages}};
  }

  /// The map of the first drive.
  std::string first() {
    const std::string map = path("first.engram");
    if (!fs::exists(map)) {
      const RunResult made = slam({config(), "--rawlog", path("1.rawlog"), "--map", map, "-q"});
      EXPECT_EQ(made.code, kOk) << made.err;
    }
    return map;
  }

  void lay(const Work& work) const {
    for (const char* suffix : {"", "-wal", "-shm", "-journal"}) fs::remove(map_ + suffix);
    if (!work.start.empty()) fs::copy_file(work.start, map_);
  }

  Child start(const Work& work, const std::string& outputs = "run") const {
    std::vector<std::string> words = work.words;
    words.insert(words.end(), {"--map", map_});
    return Child(words, path(outputs));
  }

  /// The map after each commit of an undisturbed run, as dumps.
  std::vector<std::string> undisturbed(const Work& work) {
    lay(work);
    std::vector<std::string> dumps;
    if (!work.start.empty()) dumps.push_back(dumpOf(map_));
    std::vector<std::pair<std::string, std::string>> files;
    {
      store::test::FaultyVfs vfs;
      vfs.watchSyncs(map_ + "-wal", [&] { files.emplace_back(bytesOf(map_), bytesOf(map_ + "-wal")); });
      std::vector<std::string> words(work.words.begin() + 1, work.words.end());
      words.insert(words.end(), {"--map", map_});
      const RunResult run = work.words.front() == "engram-slam" ? slam(words) : localize(words);
      EXPECT_EQ(run.code, kOk) << run.err;
    }
    for (const auto& [data, log] : files) {
      writeBytes(path("at"), data);
      writeBytes(path("at-wal"), log);
      fs::remove(path("at-shm"));
      try {
        dumps.push_back(dumpOf(path("at")));
      } catch (const base::Error&) {
        EXPECT_TRUE(work.start.empty() && dumps.empty());  // only before there is a map
      }
    }
    dumps.push_back(dumpOf(map_));
    dumps.erase(std::unique(dumps.begin(), dumps.end()), dumps.end());
    return dumps;
  }

  /// Kills the program `times` times; how often it was under way.
  int killAndCompare(const Work& work, int times, std::uint64_t seed) {
    const std::vector<std::string> prefixes = undisturbed(work);
    EXPECT_GT(prefixes.size(), kImages / 2);
    base::Rng rng(seed);
    int killed = 0;
    for (int k = 0; k < times && !HasFailure(); ++k) {
      lay(work);
      const int moment = work.imagesBefore + static_cast<int>(rng.below(kImages));
      const milliseconds later(rng.below(60));
      SCOPED_TRACE("kill " + std::to_string(k) + " " + std::to_string(later.count()) + " ms after image " +
                   std::to_string(moment));
      Child program = start(work);
      while (program.running() && imagesIn(map_) < moment) std::this_thread::sleep_for(milliseconds(1));
      std::this_thread::sleep_for(later);
      const int before = imagesIn(map_);
      killed += program.killNow() == -SIGKILL;
      expectPrefix(prefixes, before);
    }
    return killed;
  }

  /// The killed map is one of the undisturbed run, with all images that another program had seen in it.
  void expectPrefix(const std::vector<std::string>& prefixes, int seen) const {
    std::string found;
    try {
      const auto file = store::MapFile::open(map_, store::Access::kReadOnly);
      EXPECT_THAT(file.check(), IsEmpty());
      EXPECT_GE(static_cast<int>(file.records().size()), seen);
      found = dumpOf(map_);
    } catch (const base::Error& e) {
      EXPECT_EQ(seen, 0) << e.what();
      EXPECT_THAT(e.what(), Not(HasSubstr("damaged")));
      return;
    }
    EXPECT_TRUE(std::find(prefixes.begin(), prefixes.end(), found) != prefixes.end())
        << found.substr(0, 2000);
    EXPECT_NO_THROW(store::MapFile::open(map_, store::Access::kReadWrite).close());  // the next writer
    EXPECT_EQ(dumpOf(map_), found);
    EXPECT_FALSE(fs::exists(map_ + "-wal"));
  }

  std::string map_;
};

TEST_F(KillTest, KilledProgramsLeaveWhatTheyCommitted) {
  const int kills = wished("ENGRAM_KILLS", 12);
  const int mapped = killAndCompare(mapping(), kills / 3, 41);
  const int extended = killAndCompare(extending(), kills / 3, 42);
  const int adapted = killAndCompare(adapting(), kills / 3, 43);
  RecordProperty("killed_mapping", mapped);
  RecordProperty("killed_extending", extended);
  RecordProperty("killed_adapting", adapted);
  EXPECT_GT(mapped, 0);
  EXPECT_GT(extended, 0);
  EXPECT_GT(adapted, 0);
}

/// Readers see the map after some image, never one between two.
TEST_F(KillTest, ReadersOfARunSeeWholeMaps) {
  const int readers = wished("ENGRAM_READERS", 10);
  const std::vector<std::string> prefixes = undisturbed(extending());
  const std::vector<std::string> commands = {"check", "info", "dump"};
  int during = 0, runs = 0;
  for (int r = 0; during < readers && runs < readers && !HasFailure(); ++runs) {
    lay(extending());
    Child mapper = start(extending());
    for (; mapper.running() && during < readers; ++r) {
      const std::string& command = commands[static_cast<std::size_t>(r) % commands.size()];
      Child reader({"engram-map", command, map_}, path("reader"));
      EXPECT_EQ(reader.wait(), kOk) << command << ": " << reader.err();
      EXPECT_THAT(reader.err(), Not(HasSubstr("damaged")));
      EXPECT_TRUE(command != "dump" || std::count(prefixes.begin(), prefixes.end(), reader.out()) > 0);
      during += mapper.running();
    }
    EXPECT_EQ(mapper.wait(), kOk) << mapper.err();
    EXPECT_TRUE(dumpOf(map_) == prefixes.back());
  }
  RecordProperty("readers_during_a_run", during);
  EXPECT_EQ(during, readers);
}

/// One writes, the other is refused at its start and told who writes; or, where it came after the first had
/// ended, that the map has learnt this drive.
TEST_F(KillTest, OfTwoWritersOneIsRefusedAndNothingIsLost) {
  const int pairs = wished("ENGRAM_WRITERS", 5);
  base::Rng rng(44);
  int refused = 0;
  for (int k = 0; k < pairs && !HasFailure(); ++k) {
    lay(extending());
    const milliseconds later(rng.below(400));
    SCOPED_TRACE("pair " + std::to_string(k) + ", " + std::to_string(later.count()) + " ms apart");
    Child a = start(extending(), "a");
    std::this_thread::sleep_for(later);
    Child b = start(extending(), "b");
    const int codeA = a.wait(), codeB = b.wait();
    const int written = (codeA == kOk) + (codeB == kOk);
    EXPECT_EQ(written, 1) << a.err() << b.err();
    EXPECT_EQ(soundImages(map_), kImages * 2u);
    const Child &loser = codeA == kOk ? b : a, &winner = codeA == kOk ? a : b;
    EXPECT_EQ(codeA == kOk ? codeB : codeA, kError);
    EXPECT_THAT(loser.err(), AllOf(HasSubstr(map_), Not(HasSubstr("damaged"))));
    const bool late = loser.err().find("has learnt") != std::string::npos;  // the other one had ended
    refused += !late;
    EXPECT_THAT(loser.err(), HasSubstr(late ? "--again" : std::to_string(winner.pid())));
  }
  RecordProperty("refused", refused);
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace engram::apps
