// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// engram-slam and engram-localize on a live camera: the tiny building on the wire.
#include "engram/apps/program.h"
#include "engram/capture/fake_server.h"
#include "engram/store/map_file.h"
#include "run_fixture.h"
#include "tiny_drive.h"

#include <gmock/gmock.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace engram::apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

/// Shows the first drive, image after image, from where it stood last.
class Wire {
 public:
  Wire()
      : frames_(engram::testing::firstDrive().frames),
        server_({.rate = 10.0}, frames_[0].image, [this] { return next(); }) {}

 private:
  cv::Mat next() { return next_ < frames_.size() ? frames_[next_++].image : cv::Mat(); }

  std::vector<types::Frame> frames_;
  std::atomic<std::size_t> next_{0};
  capture::FakeServer server_;
};

std::string dumpOf(const std::string& map) {
  std::ostringstream text;
  store::MapFile::open(map, store::Access::kReadOnly).dump(text);
  return text.str();
}

class LiveRun : public RunTest {
 protected:
  /// @param more keys of the camera's section
  std::string liveConfig(const std::string& more = "") const {
    return configWith("live.ini", "[front]\ndriver = EngramGigECamera\ncamera = 127.0.0.1\n" + more +
                                      "[wheels]\ndriver = CircleOdometry\nprocess_rate = 100\nspeed = 0.8\n");
  }
};

TEST_F(LiveRun, AReplayOfTheRecordingMakesTheSameMap) {
  for (const std::string odometry : {"", "odometry = wheels\n"}) {
    const std::string tag = odometry.empty() ? "a" : "b";
    const std::string config = liveConfig(odometry);
    const Wire wire;
    const RunResult live = slam({config, "--live", "front", "--plugin", ENGRAM_ODOMETRY_PLUGIN, "--map",
                                 path(tag + "live.engram"), "--record", path(tag + ".rawlog"), "--seconds",
                                 "2", "--json", path(tag + ".json"), "-q"});
    ASSERT_EQ(live.code, kOk) << live.err;
    const RunResult replay =
        slam({config, "--rawlog", path(tag + ".rawlog"), "--map", path(tag + "replay.engram"), "-q"});
    ASSERT_EQ(replay.code, kOk) << replay.err;
    const std::size_t images = soundImages(path(tag + "live.engram"));
    EXPECT_GT(images, 3u);
    EXPECT_EQ(dumpOf(path(tag + "live.engram")), dumpOf(path(tag + "replay.engram")));

    const auto j = jsonOf(path(tag + ".json"));
    EXPECT_EQ(j["images"], images);
    EXPECT_EQ(j["live"]["recorded"], images);
    EXPECT_GT(j["live"]["latency_ms"]["mean"], 0.0);
    EXPECT_GE(j["live"]["latency_ms"]["max"], j["live"]["latency_ms"]["p95"]);
    const std::size_t known =
        images + j["live"]["dropped"].get<std::size_t>() + j["live"]["without_odometry"].get<std::size_t>();
    EXPECT_LE(known, j["live"]["captured"]);
    EXPECT_GE(known + 3, j["live"]["captured"]);  // the queue and the last one, which came after the time
  }
}

TEST_F(LiveRun, LocalisesAndStreamsToStandardOutput) {
  const std::string map = mapCopy();
  const Wire wire;
  ::testing::internal::CaptureStdout();
  const RunResult r = localize({liveConfig(), "--live", "front", "--map", map, "--stream", "-", "--seconds",
                                "2", "--report", path("report"), "--json", path("l.json")});
  const std::string stream = ::testing::internal::GetCapturedStdout();
  ASSERT_EQ(r.code, kOk) << r.err;
  EXPECT_EQ(r.out, "");
  EXPECT_THAT(r.err, HasSubstr("ms from exposure to belief"));
  std::istringstream lines(stream);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(nlohmann::json::parse(line)["stream"], "engram");
  int n = 0, accepted = 0;
  while (std::getline(lines, line)) {
    const auto j = nlohmann::json::parse(line);
    EXPECT_EQ(j["index"], n++);
    EXPECT_GT(j["latency_ms"], 0.0);
    EXPECT_FALSE(j["belief"].empty());
    accepted += j["outcome"] == "recognised";
    EXPECT_EQ(j["pose"].is_null(), j["outcome"] != "recognised");
  }
  EXPECT_EQ(n, jsonOf(path("l.json"))["images"]);
  EXPECT_GT(accepted, 0);  // these very images made the map
  EXPECT_THAT(bytesOf(path("report") + "/images.jsonl"), HasSubstr("\"live\":{\"latency_ms\":"));
}

TEST_F(LiveRun, SaysWhatIsWrong) {
  const std::string config = liveConfig();
  const std::string map = path("m.engram");
  const auto refused = [&](const std::vector<std::string>& more, const std::string& message,
                           int code = kError) {
    std::vector<std::string> arguments = {config, "--map", map};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult r = slam(arguments);
    EXPECT_EQ(r.code, code);
    EXPECT_THAT(r.err, HasSubstr(message));
    EXPECT_FALSE(fs::exists(map));
  };
  refused({"--live", "frnt"}, "did you mean [front]?");
  refused({"--live", "front", "--rawlog", rawlog(1)}, "give one of them", kUsage);
  refused({"--rawlog", rawlog(1), "--record", path("r.rawlog")}, "are for --live", kUsage);
  refused({"--live", "front", "--set", "front.gain=hot"}, "'hot' is not a number");
  refused({"--live", "front", "--set", "front.camera=Fake_1", "--set", "front.width=9999"},
          "width = 9999 is refused");
  refused({"--live", "front", "--set", "front.camera=Fake_1", "--set", "front.odometry=wheels", "--set",
           "wheels.driver=CNoSuchSensor"},
          "[wheels] driver = CNoSuchSensor: MRPT knows no such sensor");
  refused({"--live", "front", "--set", "front.camera=Fake_1", "--stream", path("none/s")}, "--stream");
  refused({}, "--live is missing", kUsage);
  std::ofstream(path("r.rawlog")) << "precious";
  refused({"--live", "front", "--set", "front.camera=Fake_1", "--record", path("r.rawlog")},
          "exists already");
  EXPECT_THAT(slam({config, "--live", "front"}).err, HasSubstr("--live needs --map"));
  EXPECT_EQ(bytesOf(path("r.rawlog")), "precious");
}

TEST_F(LiveRun, TheExampleDescribesACamera) {
  const std::string example = ENGRAM_SOURCE_DIR "/config/live_omni.ini";
  const RunResult r = slam({example, "--live", "front", "--dump-config"});
  EXPECT_EQ(r.code, kOk) << r.err;
  EXPECT_THAT(r.out, AllOf(HasSubstr("trigger = off\n"), HasSubstr("frame_rate = 10\n")));
  // It works as it stands, and maps as fsh_omni.ini does.
  const auto pipelineOf = [](std::string dump) { return dump.substr(0, dump.find("[front]")); };
  EXPECT_EQ(pipelineOf(r.out), slam({config(), "--dump-config"}).out);
  const Wire wire;
  const RunResult live = slam({example, "--live", "front", "--set", "front.camera=127.0.0.1", "--map",
                               path("m.engram"), "--seconds", "1", "-q"});
  EXPECT_EQ(live.code, kOk) << live.err;
  EXPECT_GT(soundImages(path("m.engram")), 3u);
}

TEST_F(LiveRun, SensorsOfTheConfigurationDoNotDisturbARunOnARawlog) {
  const RunResult r = slam({liveConfig("[front.features]\nGain = 1\n"), "--dump-config"});
  EXPECT_EQ(r.code, kOk) << r.err;
  EXPECT_EQ(r.out.find("[front]"), std::string::npos);
  const RunResult live = slam({liveConfig(), "--dump-config", "--live", "front"});
  EXPECT_THAT(live.out, HasSubstr("[front]"));
  EXPECT_THAT(live.out, HasSubstr("exposure_us = 0"));
  EXPECT_THAT(slam({configWith("x.ini", "[front]\ngain = 1\n"), "--dump-config"}).err,
              HasSubstr("unknown section"));
}

}  // namespace
}  // namespace engram::apps
