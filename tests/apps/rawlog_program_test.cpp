// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "rawlog_program.h"

#include "engram/base/interrupt.h"
#include "engram/cameras/camera_rig.h"
#include "engram/sources/rawlog_source.h"
#include "program_run.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sys/wait.h>
#include <unistd.h>

namespace engram::apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

RunResult run(const std::vector<std::string>& arguments) { return runAs<RawlogProgram>(arguments); }

class RawlogTool : public testing::Test {
 protected:
  RawlogTool() {
    std::string name = (fs::temp_directory_path() / "engram_tool_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~RawlogTool() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Panoramas of soft noise in `name`/.
  std::string makeImages(const std::string& name, int n, cv::Size size = {128, 64}) const {
    fs::create_directory(path(name));
    for (int i = 0; i < n; ++i) {
      cv::Mat image(size, CV_8UC3);
      cv::RNG rng(static_cast<std::uint64_t>(i) + 1);
      rng.fill(image, cv::RNG::UNIFORM, 0, 256);
      cv::GaussianBlur(image, image, {}, 3.0);
      cv::imwrite(path(name + cv::format("/p%d.png", i)), image);
    }
    return path(name);
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  std::string bytesOf(const std::string& name) const {
    std::ifstream in(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(bytesOf(name)); }

 private:
  fs::path folder_;
};

TEST_F(RawlogTool, HelpHasExamplesEverywhere) {
  EXPECT_THAT(run({"--help"}).out, HasSubstr("Examples:"));
  for (const char* command : {"pack", "info", "unpack", "calibrate"}) {
    const RunResult result = run({command, "--help"});
    EXPECT_EQ(result.code, kOk);
    EXPECT_THAT(result.out,
                AllOf(HasSubstr("Examples:"), HasSubstr(std::string("engram-rawlog ") + command)));
  }
}

TEST_F(RawlogTool, UsageErrors) {
  EXPECT_EQ(run({}).code, kUsage);
  EXPECT_EQ(run({"pack"}).code, kUsage);
  EXPECT_EQ(run({"info", "x", "--colour"}).code, kUsage);
  EXPECT_EQ(run({"unpack", "x", "--out", "y", "--format", "gif"}).code, kUsage);
}

TEST_F(RawlogTool, PackInfoUnpackPackAgain) {
  makeImages("in", 5);
  write("in/t.csv",
        "image,stamp,x,y,yaw\np0.png,100.5,0,0,0\np1.png,101,1,0,0.1\np2.png,101.5,2,0.5,0.2\n"
        "p3.png,102,3,1,0.3\np4.png,102.5,,,\n");
  const RunResult pack = run({"pack", "--images", path("in"), "--csv", path("in/t.csv"), "--out",
                              path("a.rawlog"), "-q", "--json", path("pack.json")});
  EXPECT_EQ(pack.code, kOk) << pack.err;
  EXPECT_THAT(pack.out, HasSubstr("5 images of 128x64"));
  EXPECT_EQ(json("pack.json")["images"], 5);

  const RunResult info = run({"info", path("a.rawlog"), "--json", path("info.json")});
  EXPECT_EQ(info.code, kOk) << info.err;
  EXPECT_THAT(info.out, AllOf(HasSubstr("CObservationImage 'CAMERA': 5"),
                              HasSubstr("CObservationOdometry 'ODOMETRY': 4"),
                              HasSubstr("128x64, colour, 2.00 per second, 5 with odometry")));
  EXPECT_NEAR(json("info.json")["path_m"], 1 + 2 * std::hypot(1, 0.5), 1e-6);
  EXPECT_EQ(json("info.json")["objects"]["CObservationImage"]["CAMERA"], 5);

  const RunResult unpack = run({"unpack", path("a.rawlog"), "--out", path("b"), "-q"});
  EXPECT_EQ(unpack.code, kOk) << unpack.err;
  EXPECT_THAT(bytesOf("b/frames.csv"), HasSubstr("000002.png,101.5000000,,2,0.5,0.2\n"));
  const RunResult again =
      run({"pack", "--images", path("b"), "--csv", path("b/frames.csv"), "--out", path("c.rawlog"), "-q"});
  EXPECT_EQ(again.code, kOk) << again.err;
  auto first = sources::openRawlog(path("a.rawlog")), second = sources::openRawlog(path("c.rawlog"));
  while (auto a = first->next()) {
    const auto b = second->next();
    ASSERT_TRUE(b);
    EXPECT_NEAR(a->stamp, b->stamp, 1e-6);
    EXPECT_TRUE(a->T_odom_robot->isApprox(*b->T_odom_robot, 1e-6));
    EXPECT_LT(cv::norm(a->image, b->image, cv::NORM_L1) / (128.0 * 64 * 3), 1.0);
  }
  EXPECT_FALSE(second->next());
}

TEST_F(RawlogTool, ReprojectIsDeterministicAndSeeded) {
  makeImages("in", 3);
  const std::string camera = std::string(ENGRAM_SOURCE_DIR) + "/share/cameras/omni_world.ini";
  const auto pack = [&](const std::string& out, const std::string& seed) {
    return run({"pack", "--images", path("in"), "--reproject", camera, "--size", "160x120", "--heading",
                "random", "--seed", seed, "--out", path(out), "-q", "--json", path(out + ".json"),
                "--save-camera", path(out + ".ini")});
  };
  EXPECT_EQ(pack("a.rawlog", "3").code, kOk);
  EXPECT_EQ(pack("b.rawlog", "3").code, kOk);
  EXPECT_EQ(pack("c.rawlog", "4").code, kOk);
  EXPECT_EQ(bytesOf("a.rawlog"), bytesOf("b.rawlog"));
  EXPECT_NE(bytesOf("a.rawlog"), bytesOf("c.rawlog"));
  EXPECT_EQ(json("a.rawlog.json")["headings_deg"].size(), 3u);
  EXPECT_EQ(cameras::loadCamera(path("a.rawlog.ini")).camera->imageSize(), cv::Size(160, 120));
  auto source = sources::openRawlog(path("a.rawlog"));
  EXPECT_EQ(source->next()->image.size(), cv::Size(160, 120));
}

TEST_F(RawlogTool, NothingIsOverwrittenUnasked) {
  makeImages("in", 1);
  write("a.rawlog", "precious");
  write("c.ini", "precious");
  const RunResult pack = run({"pack", "--images", path("in"), "--out", path("a.rawlog")});
  EXPECT_EQ(pack.code, kError);
  EXPECT_THAT(pack.err, HasSubstr("exists already"));
  EXPECT_EQ(
      run({"calibrate", "--images", path("in"), "--board", "9x6", "--square", "1", "--out", path("c.ini")})
          .code,
      kError);
  EXPECT_EQ(bytesOf("a.rawlog"), "precious");
  EXPECT_EQ(bytesOf("c.ini"), "precious");
  EXPECT_EQ(run({"pack", "--images", path("in"), "--out", path("a.rawlog"), "--overwrite", "-q"}).code, kOk);
  const RunResult unpack = run({"unpack", path("a.rawlog"), "--out", path("in")});
  EXPECT_EQ(unpack.code, kError);
  EXPECT_THAT(unpack.err, HasSubstr("not empty"));
}

TEST_F(RawlogTool, BadInput) {
  makeImages("in", 2, {100, 80});
  makeImages("empty", 0);
  const std::string omni = std::string(ENGRAM_SOURCE_DIR) + "/share/cameras/omni_world.ini";
  const auto expectError = [](const RunResult& result, const std::string& part, int code = kError) {
    EXPECT_EQ(result.code, code);
    EXPECT_THAT(result.err, HasSubstr(part));
  };
  const std::string out = path("o.rawlog");
  expectError(run({"info", path("none.rawlog")}), "none.rawlog: no such file");
  expectError(run({"unpack", path("none.rawlog"), "--out", path("u")}), "no such file");
  expectError(run({"pack", "--images", path("none"), "--out", out}), "no such folder");
  expectError(run({"pack", "--images", path("empty"), "--out", out}), "holds no images");
  expectError(run({"pack", "--images", path("in"), "--reproject", omni, "--out", out}), "no full panoramas");
  expectError(run({"pack", "--images", path("in"), "--reproject", path("no.ini"), "--out", out}), "no.ini");
  expectError(run({"pack", "--images", path("in"), "--heading", "left", "--reproject", omni, "--out", out}),
              "expected degrees or the word random", kUsage);
  expectError(run({"pack", "--images", path("in"), "--heading", "30", "--out", out}),
              "only together with --reproject", kUsage);
  expectError(run({"pack", "--images", path("in"), "--size", "640", "--out", out}), "such as 640x480",
              kUsage);
  expectError(run({"pack", "--images", path("in"), "--out", path("none/o.rawlog")}), "does not exist");
  expectError(
      run({"calibrate", "--images", path("in"), "--board", "9x6", "--square", "0.03", "--out", out, "-q"}),
      "the board was found in 0 images");
  expectError(run({"calibrate", "--board", "9x6", "--square", "0.03", "--out", out}),
              "either --images DIR or --rawlog", kUsage);
  expectError(run({"calibrate", "--images", path("in"), "--board", "9", "--square", "0.03", "--out", out}),
              "--board '9'", kUsage);
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(RawlogTool, RealRawlogWithoutImages) {
  const std::string file = "/usr/share/mrpt/datasets/localization_demo.rawlog";
  if (!fs::exists(file)) {
    if (std::getenv("CI")) FAIL() << file << " is missing: install mrpt-common";
    GTEST_SKIP() << file << " is missing: install mrpt-common";
  }
  const RunResult info = run({"info", file, "-q"});
  EXPECT_EQ(info.code, kOk);
  EXPECT_THAT(info.out, HasSubstr("odometry: 37 readings, path 13.00 m"));
  EXPECT_THAT(info.err, HasSubstr("but no images"));
  EXPECT_EQ(run({"unpack", file, "--out", path("u")}).code, kError);
  EXPECT_FALSE(fs::exists(path("u")));
}

TEST_F(RawlogTool, DamagedInputIsUsedInPartAndSaid) {
  makeImages("in", 6);
  ASSERT_EQ(run({"pack", "--images", path("in"), "--out", path("a.rawlog"), "-q"}).code, kOk);
  fs::resize_file(path("a.rawlog"), fs::file_size(path("a.rawlog")) / 2);
  const RunResult info = run({"info", path("a.rawlog"), "--json", path("i.json"), "-q"});
  EXPECT_EQ(info.code, kPartial);
  EXPECT_THAT(info.err, AllOf(HasSubstr("truncated"), HasSubstr("images read")));
  EXPECT_THAT(json("i.json")["damage"].get<std::string>(), HasSubstr("truncated"));
  const RunResult unpack = run({"unpack", path("a.rawlog"), "--out", path("u"), "-q"});
  EXPECT_EQ(unpack.code, kPartial);
  EXPECT_TRUE(fs::exists(path("u/000001.png")));

  write("in/p3.png", "no image");
  const RunResult pack = run({"pack", "--images", path("in"), "--out", path("b.rawlog"), "-q"});
  EXPECT_EQ(pack.code, kPartial);
  EXPECT_THAT(pack.err, HasSubstr("p3.png: not an image"));
  EXPECT_THAT(pack.out, HasSubstr("5 images"));
}

using RawlogToolDeathTest = RawlogTool;  // GoogleTest runs these first, before OpenCV has threads

// Ctrl-C before the work: everything must still end in order. In a process of its own, as the flag stays set.
TEST_F(RawlogToolDeathTest, InterruptEndsInOrder) {
  cv::setNumThreads(1);
  makeImages("in", 2);
  ASSERT_EQ(run({"pack", "--images", path("in"), "--out", path("a.rawlog"), "-q"}).code, kOk);
  const auto afterSignal = [](const std::vector<std::string>& arguments) {
    base::installInterruptHandler();
    std::raise(SIGINT);
    const RunResult result = run(arguments);
    std::cerr << result.err;
    std::_Exit(result.code);
  };
  EXPECT_EXIT(afterSignal({"info", path("a.rawlog")}), testing::ExitedWithCode(kPartial), "interrupted");
  EXPECT_EXIT(afterSignal({"unpack", path("a.rawlog"), "--out", path("u")}),
              testing::ExitedWithCode(kPartial), "interrupted");
  EXPECT_EXIT(afterSignal({"pack", "--images", path("in"), "--out", path("b.rawlog")}),
              testing::ExitedWithCode(kPartial), "interrupted before the first image");
  EXPECT_EXIT(afterSignal({"calibrate", "--images", path("in"), "--board", "9x6", "--square", "1", "--out",
                           path("c.ini")}),
              testing::ExitedWithCode(kPartial), "no calibration was written");
  EXPECT_FALSE(fs::exists(path("b.rawlog")));
  EXPECT_TRUE(fs::exists(path("u/frames.csv")));
}

TEST_F(RawlogTool, TheProgramItselfRuns) {
  const std::string program = std::string(ENGRAM_BIN_DIR) + "/engram-rawlog";
  const auto codeOf = [&](const std::string& arguments) {
    return WEXITSTATUS(std::system((program + " " + arguments + " > /dev/null 2>&1").c_str()));
  };
  EXPECT_EQ(codeOf("--help"), kOk);
  EXPECT_EQ(codeOf("info"), kUsage);
  EXPECT_EQ(codeOf("info " + path("none.rawlog")), kError);
}

}  // namespace
}  // namespace engram::apps
