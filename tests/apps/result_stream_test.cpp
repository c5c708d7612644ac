// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/result_stream.h"

#include "engram/apps/pose_tracker.h"
#include "engram/apps/run_stream.h"
#include "engram/base/error.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <future>
#include <numbers>
#include <sstream>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace engram::apps {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// A program that reads the stream.
class Client {
 public:
  explicit Client(const std::string& path) : socket_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    const timeval patience{5, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  ~Client() { ::close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// The next line; empty when the stream has ended.
  std::string line() {
    std::size_t end;
    while ((end = buffer_.find('\n')) == std::string::npos) {
      char chunk[4096];
      const auto n = ::read(socket_, chunk, sizeof chunk);
      if (n <= 0) return {};
      buffer_.append(chunk, static_cast<std::size_t>(n));
    }
    std::string result = buffer_.substr(0, end);
    buffer_.erase(0, end + 1);
    return result;
  }

 private:
  int socket_;
  std::string buffer_;
};

class ResultStreamTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "engram_stream_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string socket() const { return folder_ + "/s"; }
  static void waitForReaders(const ResultStream& stream, std::size_t n) {
    while (stream.readers() != n) std::this_thread::sleep_for(1ms);
  }

  std::string folder_;
};

// They read meanwhile: a socket that nobody reads takes 69 lines, if each was written by itself.
TEST_F(ResultStreamTest, EveryReaderGetsEveryLine) {
  std::vector<std::future<std::vector<std::string>>> read;
  {
    ResultStream stream(socket(), "hello");
    for (int i = 0; i < 3; ++i)
      read.push_back(std::async(std::launch::async, [client = std::make_shared<Client>(socket())] {
        std::vector<std::string> lines;
        for (std::string line = client->line(); !line.empty(); line = client->line()) lines.push_back(line);
        return lines;
      }));
    waitForReaders(stream, 3);
    for (int i = 0; i < 500; ++i) stream.send("line " + std::to_string(i));
    EXPECT_EQ(stream.missed(), 0u);
  }
  std::vector<std::string> all{"hello"};
  for (int i = 0; i < 500; ++i) all.push_back("line " + std::to_string(i));
  for (auto& lines : read) EXPECT_EQ(lines.get(), all);
  EXPECT_FALSE(fs::exists(socket()));
}

TEST_F(ResultStreamTest, AStuckReaderHoldsUpNobody) {
  ResultStream stream(socket(), "hello");
  Client stuck(socket()), quick(socket());
  waitForReaders(stream, 2);
  const std::string tail(990, 'x');
  double longest = 0.0;
  for (int i = 0; i < 3000; ++i) {  // 3 MB: far more than any buffer on the way
    const auto start = std::chrono::steady_clock::now();
    stream.send(std::to_string(i) + tail);
    longest =
        std::max(longest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    if (i == 0) {
      EXPECT_EQ(quick.line(), "hello");
    }
    ASSERT_EQ(quick.line(), std::to_string(i) + tail);
  }
  EXPECT_LT(longest, 1.0);  // it does not wait for the stuck one, which would be for ever
  EXPECT_GT(stream.missed(), 100u);
  // What the stuck one reads in the end are whole lines, in order, with gaps.
  EXPECT_EQ(stuck.line(), "hello");
  int last = -1;
  while (last < 2999) {
    const std::string line = stuck.line();
    ASSERT_GT(line.size(), 990u);
    ASSERT_EQ(line.substr(line.size() - 990), tail);
    const int number = std::stoi(line);
    ASSERT_GT(number, last);
    last = number;
  }
}

TEST_F(ResultStreamTest, ReadersComeAndGo) {
  ResultStream stream(socket(), "hello");
  stream.send("nobody hears this");
  {
    Client first(socket());
    EXPECT_EQ(first.line(), "hello");
    stream.send("one");
    EXPECT_EQ(first.line(), "one");
  }
  waitForReaders(stream, 0);
  stream.send("two");
  Client second(socket());
  EXPECT_EQ(second.line(), "hello");
  stream.send("three");
  EXPECT_EQ(second.line(), "three");
}

TEST_F(ResultStreamTest, TakesOverASocketOfACrashedProgramOnly) {
  const auto refusal = [](const std::string& target) -> std::string {
    try {
      const ResultStream stream(target, "hello");
    } catch (const base::Error& e) {
      return e.what();
    }
    return {};
  };
  {
    const ResultStream alive(socket(), "hello");
    EXPECT_THAT(refusal(socket()), HasSubstr("another program streams there"));
  }
  const int abandoned = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  socket().copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(::bind(abandoned, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ::close(abandoned);
  EXPECT_TRUE(fs::exists(socket()));
  EXPECT_EQ(refusal(socket()), "");
  std::ofstream(folder_ + "/file") << "precious";
  EXPECT_THAT(refusal(folder_ + "/file"), HasSubstr("is no socket"));
  EXPECT_THAT(refusal(folder_ + "/none/s"), HasSubstr("--stream " + folder_ + "/none/s: No such file"));
  EXPECT_THAT(refusal(std::string(200, 'x')), HasSubstr("too long"));
}

/// Open files of this process, limited for as long as this lives.
class FileLimit {
 public:
  explicit FileLimit(rlim_t most) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit limit{most, before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &limit);
  }
  ~FileLimit() { ::setrlimit(RLIMIT_NOFILE, &before_); }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  rlimit before_{};
};

/// Readers in a process of their own, so that their descriptors are not ours. They try until all are
/// connected, and go with this object.
class Crowd {
 public:
  Crowd(const std::string& path, int readers) : process_(fork()) {
    if (process_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    for (int i = 0; i < readers; ++i) {
      const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0);
      while (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
        usleep(1000);
    }
    pause();
    std::_Exit(0);
  }
  ~Crowd() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

 private:
  pid_t process_;
};

/// How often a reader may have been found waiting in `time`: twice a second, and not thousands of times.
double atMostIn(Clock::duration time) { return 2.0 + std::chrono::duration<double>(time).count() / 0.5; }

TEST_F(ResultStreamTest, ACrowdOfReadersLeavesTheRunItsDescriptors) {
  auto crowd = std::make_unique<Crowd>(socket(), 320);  // before there are threads, and before the limit
  const FileLimit limit(128);
  const auto start = Clock::now();
  ResultStream stream(socket(), "hello");
  EXPECT_EQ(stream.mostReaders(), 64u);
  waitForReaders(stream, 64);
  while (stream.postponed() < 2) std::this_thread::sleep_for(1ms);
  EXPECT_LE(static_cast<double>(stream.postponed()), atMostIn(Clock::now() - start));
  EXPECT_EQ(stream.readers(), 64u);
  std::vector<int> files;  // what the run opens: a map, a rawlog, a camera
  while (files.size() < 40) files.push_back(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  EXPECT_THAT(files, ::testing::Each(::testing::Ge(0)));
  for (const int file : files) ::close(file);
  crowd.reset();
  waitForReaders(stream, 0);
  Client late(socket());
  EXPECT_EQ(late.line(), "hello");
}

TEST_F(ResultStreamTest, WithoutDescriptorsReadersWaitInPeace) {
  const Crowd crowd(socket(), 20);
  const FileLimit limit(128);
  const auto start = Clock::now();
  ResultStream stream(socket(), "hello");
  waitForReaders(stream, 20);
  std::vector<int> files;
  for (int file; (file = ::open("/dev/null", O_RDONLY | O_CLOEXEC)) >= 0;) files.push_back(file);
  ASSERT_EQ(errno, EMFILE);
  ::close(files.back());
  files.pop_back();
  Client late(socket());  // takes the last descriptor
  while (stream.postponed() < 2) std::this_thread::sleep_for(1ms);
  EXPECT_LE(static_cast<double>(stream.postponed()), atMostIn(Clock::now() - start));
  EXPECT_EQ(stream.readers(), 20u);
  for (const int file : files) ::close(file);
  EXPECT_EQ(late.line(), "hello");  // its turn has come
}

TEST_F(ResultStreamTest, ThatReadersWaitIsSaidOnce) {
  const FileLimit limit(66);
  RunStream stream;
  CLI::App app;
  stream.declare(app);
  app.parse(std::vector<std::string>{socket(), "--stream"});  // CLI11 wants them in reverse
  std::ostringstream notices;
  stream.open("m.engram", notices);
  const Client first(socket()), second(socket()), third(socket());
  const map::TopologicalMap map;
  while (notices.str().empty()) {
    stream.sendLocalised({}, map);
    std::this_thread::sleep_for(1ms);
  }
  const std::string said = notices.str();
  EXPECT_THAT(said, HasSubstr("more readers than can be served (2 at most"));
  for (int i = 0; i < 20; ++i) stream.sendLocalised({}, map);
  EXPECT_EQ(notices.str(), said);
  stream.close(notices);
  EXPECT_THAT(notices.str(), HasSubstr("readers had to wait (found "));
}

TEST(StreamLine, HasTheDocumentedKeys) {
  types::FrameReport report;
  report.index = 7;
  report.stamp = 1700000000.5;
  report.outcome = types::Outcome::kRecognised;
  report.place = report.bestGuess = base::PlaceId(3);
  report.hypotheses = {{base::PlaceId(3), 0.8, 0.75, 44}, {base::PlaceId(9), 0.2, 0.125, -1}};
  report.newPlaceProbability = 0.0625;
  report.live.emplace().latency = 17.25;
  const StreamPose pose{{1.5, -2.0, 0.0}, std::numbers::pi / 2};
  EXPECT_EQ(streamLine(report, pose),
            R"({"index":7,"stamp":1700000000.5,"outcome":"recognised","place":3,"best_guess":3,)"
            R"("pose":{"x":1.5,"y":-2.0,"z":0.0,"heading_deg":90.0},)"
            R"("belief":[{"place":3,"probability":0.75},{"place":9,"probability":0.125}],)"
            R"("new_place":0.0625,"inliers":44,"latency_ms":17.25})");
  EXPECT_EQ(
      streamLine({}, std::nullopt),
      R"({"index":0,"stamp":0.0,"outcome":"skipped","place":null,"best_guess":null,"pose":null,"belief":[],)"
      R"("new_place":0.0,"inliers":null,"latency_ms":null})");
  EXPECT_EQ(nlohmann::json::parse(streamLine({}, StreamPose{{0, 0, 0}, std::nullopt}))["pose"]["heading_deg"],
            nullptr);
  report.pose.emplace().T_place_robot.cov.diagonal() << 0.04 * 0.04, 0.01, 1, 1, 1, 1e-4;
  const auto known = nlohmann::json::parse(streamLine(report, pose))["pose"];
  EXPECT_EQ(known["sigma_along"], 0.04);
  EXPECT_EQ(known["sigma_across"], 0.1);
  EXPECT_NEAR(known["sigma_heading_deg"], 0.572958, 1e-6);
}

Eigen::Isometry3d pose(double x, double y, double yaw) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(x, y, 0);
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

TEST(PoseTracker, CarriesAFixOnByOdometry) {
  // The odometry frame lies anywhere in the map.
  const Eigen::Isometry3d T_map_odom = pose(10, -3, 0.7);
  PoseTracker tracker;
  EXPECT_FALSE(tracker.T_map_robot());
  tracker.update(std::nullopt, pose(0, 0, 0));
  EXPECT_FALSE(tracker.T_map_robot());
  for (int i = 0; i < 50; ++i) {
    const Eigen::Isometry3d odom = pose(0.1 * i, 0.02 * i, 0.05 * i);
    const bool found = i % 10 == 0;
    tracker.update(found ? std::optional(T_map_odom * odom) : std::nullopt, odom);
    ASSERT_TRUE(tracker.T_map_robot());
    EXPECT_TRUE(tracker.T_map_robot()->isApprox(T_map_odom * odom, 1e-9)) << i;
  }
}

TEST(PoseTracker, DoesNotGuessWithoutOdometry) {
  PoseTracker tracker;
  tracker.update(pose(1, 2, 0), std::nullopt);
  EXPECT_TRUE(tracker.T_map_robot());
  tracker.update(std::nullopt, pose(0, 0, 0));
  EXPECT_FALSE(tracker.T_map_robot());  // nobody knows how far it went since
  tracker.update(pose(1, 2, 0), pose(0, 0, 0));
  tracker.update(std::nullopt, std::nullopt);
  EXPECT_FALSE(tracker.T_map_robot());
}

}  // namespace
}  // namespace engram::apps
