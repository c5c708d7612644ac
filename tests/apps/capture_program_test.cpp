// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// engram-capture end to end with Aravis' simulated camera, which needs no network.
#include "capture_program.h"

#include "camera_process.h"
#include "engram/sources/rawlog_source.h"
#include "engram/sources/rawlog_writer.h"
#include "program_process.h"
#include "program_run.h"
#include "rawlog_fixture.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <fstream>
#include <sys/resource.h>
#include <thread>

namespace engram::apps {
namespace {

using engram::testing::ChildProcess;
using sources::test::TempFolder;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
namespace fs = std::filesystem;
using namespace std::chrono_literals;

RunResult capture(const std::vector<std::string>& arguments) { return runAs<CaptureProgram>(arguments); }

std::vector<std::string> record(const std::string& out, std::vector<std::string> more) {
  std::vector<std::string> arguments = {"record", "--camera",  "Fake_1", "--set", "width=64",
                                        "--set",  "height=48", "--out",  out,     "-q"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

nlohmann::json jsonOf(const std::string& path) {
  std::ifstream in(path);
  return nlohmann::json::parse(in);
}

std::vector<types::Frame> framesIn(const std::string& path, std::string* problem = nullptr) {
  auto source = sources::openRawlog(path);
  auto frames = sources::test::readFrames(*source);
  if (problem) *problem = source->problem();
  return frames;
}

double systemNow() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

TEST(Capture, RecordsWhatTheCameraTakes) {
  const TempFolder folder;
  const auto r = capture(record(folder.path("a.rawlog"), {"--set", "frame_rate=50", "--images", "40",
                                                          "--json", folder.path("a.json")}));
  EXPECT_EQ(r.code, kOk) << r.err;
  std::string problem;
  const auto frames = framesIn(folder.path("a.rawlog"), &problem);
  EXPECT_EQ(problem, "");
  ASSERT_EQ(frames.size(), 40u);
  EXPECT_EQ(frames[0].image.size(), cv::Size(64, 48));
  const auto j = jsonOf(folder.path("a.json"));
  EXPECT_EQ(j["frames"], 40);
  EXPECT_EQ(j["incomplete"], 0);
  EXPECT_EQ(j["dropped"], 0);
  EXPECT_EQ(j["width"], 64);
  EXPECT_GT(j["fps"], 20.0);
  EXPECT_LT(j["fps"], 60.0);
  EXPECT_TRUE(j.contains("missed"));
  EXPECT_THAT(r.out, HasSubstr("40 images"));

  const auto checked = capture({"check", folder.path("a.rawlog"), "-q", "--json", folder.path("c.json")});
  EXPECT_EQ(checked.code, kOk) << checked.err;
  EXPECT_NEAR(jsonOf(folder.path("c.json"))["fps"], j["fps"], 1e-3);
}

TEST(Capture, StopsAfterTheSecondsByTheStampsOfTheImages) {
  const TempFolder folder;
  const auto r = capture(record(folder.path("a.rawlog"), {"--set", "frame_rate=50", "--seconds", "0.7"}));
  EXPECT_EQ(r.code, kOk) << r.err;
  const auto frames = framesIn(folder.path("a.rawlog"));
  EXPECT_LT(frames.back().stamp - frames.front().stamp, 0.7);
  EXPECT_GT(frames.back().stamp - frames.front().stamp, 0.5);
}

TEST(Capture, RecordsOdometryOfAnMrptSensorBesideTheImages) {
  const TempFolder folder;
  const std::string config = folder.path("robot.ini");
  std::ofstream(config) << "[front]\ndriver = EngramGigECamera\ncamera = Fake_1\nwidth = 64\nheight = 48\n"
                           "frame_rate = 40\nodometry = wheels\nsensor_label = FRONT\n"
                           "[wheels]\ndriver = CircleOdometry\nprocess_rate = 100\nspeed = 1\nturn = 0.5\n"
                           "sensorLabel = WHEELS\n[extractor]\nextractor = surf\n";
  const auto r = capture({"record", config, "--plugin", ENGRAM_ODOMETRY_PLUGIN, "--images", "30", "--out",
                          folder.path("a.rawlog"), "--json", folder.path("a.json"), "-q"});
  ASSERT_EQ(r.code, kOk) << r.err;
  EXPECT_GT(jsonOf(folder.path("a.json"))["objects"], 30);
  auto source = sources::openRawlog(folder.path("a.rawlog"));
  const auto frames = sources::test::readFrames(*source);
  ASSERT_EQ(frames.size(), 30u);
  EXPECT_EQ(source->stats().objects.at("CObservationOdometry").count("WHEELS"), 1u);
  EXPECT_EQ(source->stats().cameras.count("FRONT"), 1u);
  for (std::size_t i = 5; i + 5 < frames.size(); ++i) {
    ASSERT_TRUE(frames[i].T_odom_robot);
    const double yaw = 0.5 * std::fmod(frames[i].stamp, 1e5);  // the plug-in's circle at this very instant
    const Eigen::Vector3d truth(2.0 * std::sin(yaw), 2.0 * (1.0 - std::cos(yaw)), 0.0);
    EXPECT_LT((frames[i].T_odom_robot->translation() - truth).norm(), 1e-3);
  }
}

TEST(Capture, BeginsNewFiles) {
  const TempFolder folder;
  const auto r =
      capture(record(folder.path("a.rawlog"), {"--set", "frame_rate=50", "--images", "40", "--rotate-minutes",
                                               "0.005", "--external", "--json", folder.path("a.json")}));
  EXPECT_EQ(r.code, kOk) << r.err;
  const auto j = jsonOf(folder.path("a.json"));
  ASSERT_GE(j["files"].size(), 2u);
  std::size_t images = 0;
  for (const auto& file : j["files"]) images += framesIn(file["path"]).size();
  EXPECT_EQ(images, 40u);
  EXPECT_TRUE(fs::is_directory(folder.path("a_001_Images")));
}

TEST(Capture, AKilledRecordingLosesAtMostTheLastSecond) {
  const TempFolder folder;
  const std::string path = folder.path("a.rawlog");
  std::vector<std::string> command = record(path, {"--set", "frame_rate=50"});
  command.insert(command.begin(), ENGRAM_BIN_DIR "/engram-capture");
  ChildProcess recorder(command);
  const auto patience = std::chrono::steady_clock::now() + 20s;
  while ((!fs::exists(path) || fs::file_size(path) < 10000) && std::chrono::steady_clock::now() < patience)
    std::this_thread::sleep_for(20ms);
  const double killed = systemNow();
  ASSERT_TRUE(WIFSIGNALED(recorder.end(SIGKILL)));
  const auto frames = framesIn(path);
  ASSERT_GT(frames.size(), 10u);
  EXPECT_LT(killed - frames.back().stamp, 1.0);
}

TEST(Capture, AFullDiskKeepsWhatWasRecorded) {
  const TempFolder folder;
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const rlimit limit{16000, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &limit);
  const auto r = capture(record(folder.path("a.rawlog"), {"--set", "frame_rate=100", "--seconds", "30"}));
  setrlimit(RLIMIT_FSIZE, &old);
  EXPECT_EQ(r.code, kPartial);
  EXPECT_THAT(r.err, HasSubstr("free some space"));
  std::string problem;
  const auto frames = framesIn(folder.path("a.rawlog"), &problem);
  EXPECT_EQ(problem, "");
  EXPECT_GT(frames.size(), 5u);
  EXPECT_THAT(r.out, HasSubstr(std::to_string(frames.size()) + " images"));
}

// Its first message was once written into the rawlog, which had got the number of standard error.
TEST(Capture, WithoutStandardErrorTheRecordingIsWhole) {
  const TempFolder folder;
  std::vector<std::string> command =
      record(folder.path("a.rawlog"), {"--set", "frame_rate=50", "--images", "9"});
  command.insert(command.begin(), "engram-capture");
  std::erase(command, "-q");
  const int null = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  const int status = testing::ProgramProcess{command, null}.run();
  ::close(null);
  EXPECT_EQ(WEXITSTATUS(status), kOk);
  std::string problem;
  EXPECT_EQ(framesIn(folder.path("a.rawlog"), &problem).size(), 9u);
  EXPECT_EQ(problem, "");
}

// A camera that does not answer is no reason to lose the recording of yesterday.
TEST(Capture, AnEarlierRecordingStaysUntilThereIsAnImage) {
  const TempFolder folder;
  std::ofstream(folder.path("a.rawlog")) << "yesterday";
  const auto r = capture(record(folder.path("a.rawlog"), {"--overwrite", "--set", "width=5000"}));
  EXPECT_EQ(r.code, kError);
  EXPECT_EQ(sources::test::readAll(folder.path("a.rawlog")).size(), 9u);
}

TEST(Capture, SaysWhatIsWrong) {
  const TempFolder folder;
  const std::string out = folder.path("a.rawlog");
  const auto refused = [&](const std::vector<std::string>& more, const std::string& message,
                           int code = kError) {
    const auto r = capture(record(out, more));
    EXPECT_EQ(r.code, code) << r.err;
    EXPECT_THAT(r.err, HasSubstr(message));
    EXPECT_FALSE(fs::exists(out));
  };
  refused({"--set", "width=5000"}, "width = 5000 is refused");
  refused({"--set", "expsure_us=5"}, "did you mean 'exposure_us'?");
  refused({"--set", "pixel_format=Mono7"}, "pixel_format = Mono7 is refused");
  refused({"--feature", "Nonsense"}, "expected NAME=VALUE", kUsage);
  refused({"--feature", "Nonsense=1"}, "feature Nonsense = 1 is refused");
  refused({"--plugin", "/nowhere.so"}, "no such file");
  refused({"--seconds", "-3"}, "--seconds", kUsage);
  refused({"--right", "Fake_1"}, "right_camera: 'Fake_1' is the left camera too");
  refused({"--json", folder.path("none/x.json")}, "does not exist");

  std::ofstream(out) << "precious";
  const auto r = capture(record(out, {}));
  EXPECT_EQ(r.code, kError);
  EXPECT_THAT(r.err, HasSubstr("exists already"));

  std::ofstream(folder.path("two.ini")) << "[a]\ndriver = EngramGigECamera\n[b]\ndriver = EngramGigECamera\n";
  EXPECT_THAT(capture({"record", folder.path("two.ini"), "--out", folder.path("x.rawlog")}).err,
              HasSubstr("describes [a], [b]"));
  std::ofstream(folder.path("none.ini")) << "[a]\nx = 1\n";
  EXPECT_THAT(capture({"record", folder.path("none.ini"), "--out", folder.path("x.rawlog")}).err,
              HasSubstr("give --section"));
  EXPECT_EQ(capture({}).code, kUsage);
}

TEST(Capture, CheckFindsGapsAndDamage) {
  const TempFolder folder;
  const std::string path = folder.path("a.rawlog");
  {
    sources::RawlogWriter writer(path);
    for (int i = 0; i < 100; ++i) {
      if (i >= 40 && i < 45) continue;
      types::Frame frame;
      frame.stamp = sources::test::kStart + 0.1 * i;
      frame.image = sources::test::picture(i);
      writer.add(frame);
    }
    writer.close();
  }
  const auto r = capture({"check", path, "-q", "--json", folder.path("c.json")});
  EXPECT_EQ(r.code, kOk);
  const auto j = jsonOf(folder.path("c.json"));
  EXPECT_EQ(j["frames"], 95);
  EXPECT_EQ(j["missing"], 5);
  EXPECT_NEAR(j["loss"], 0.05, 1e-9);
  EXPECT_THAT(r.out, HasSubstr("0.60 s after 3.90 s, 5 images"));
  EXPECT_EQ(capture({"check", path, "-q", "--max-loss", "0.04"}).code, kPartial);

  auto bytes = sources::test::readAll(path);
  bytes.resize(bytes.size() / 2);
  sources::test::writeAll(path, bytes);
  const auto damaged = capture({"check", path, "-q"});
  EXPECT_EQ(damaged.code, kPartial);
  EXPECT_THAT(damaged.err, HasSubstr("truncated"));
  EXPECT_EQ(capture({"check", folder.path("none.rawlog")}).code, kError);
}

}  // namespace
}  // namespace engram::apps
