// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "rawlog_program.h"

#include "engram/base/interrupt.h"
#include "engram/cameras/camera_rig.h"
#include "engram/sources/rawlog_source.h"
#include "engram/sources/rawlog_writer.h"
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
#include <set>
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
  const RunResult comma =
      run({"calibrate", "--images", "x", "--board", "9x6", "--square", "0,03", "--out", "y"});
  EXPECT_EQ(comma.code, kUsage);
  EXPECT_THAT(comma.err, HasSubstr("--square: '0,03' is not a number: the decimal sign is a point, 0.03"));
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
  EXPECT_THAT(bytesOf("b/frames.csv"), HasSubstr("p2.png,101.5000000,,2,0.5,0.2\n"));
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

/// Six images, 0.1 s apart, with stamps in this unit; half a second is 500 milliseconds.
std::string stampedCsv(long long first, long long step) {
  std::string csv = "image,stamp\n";
  for (int i = 0; i < 6; ++i) csv += cv::format("p%d.png,%lld\n", i, first + step * i);
  return csv;
}

std::vector<types::Frame> framesOf(const std::string& path) {
  auto source = sources::openRawlog(path);
  std::vector<types::Frame> frames;
  while (auto frame = source->next()) frames.push_back(std::move(*frame));
  EXPECT_EQ(source->problem(), "");
  return frames;
}

TEST_F(RawlogTool, StampsInAnyUnitMakeTheSameRawlog) {
  makeImages("in", 6);
  const auto pack = [&](const std::string& csv, std::vector<std::string> more) {
    write("t.csv", csv);
    more.insert(more.begin(), {"pack", "--images", path("in"), "--csv", path("t.csv"), "--out",
                               path("a.rawlog"), "-q", "--overwrite", "--json", path("j.json")});
    return run(more);
  };
  for (const auto& [unit, perSecond] :
       std::vector<std::pair<std::string, long long>>{{"ms", 1000}, {"us", 1000000}, {"ns", 1000000000}}) {
    const RunResult result = pack(stampedCsv(1700000000 * perSecond, perSecond / 10), {});
    EXPECT_EQ(result.code, kOk) << result.err;
    EXPECT_THAT(result.out,
                AllOf(HasSubstr("taken for"), HasSubstr("since 1970; --stamp-unit forces another")));
    EXPECT_EQ(json("j.json")["stamp_unit"], unit);
    const auto frames = framesOf(path("a.rawlog"));
    ASSERT_EQ(frames.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(frames[i].stamp, 1.7e9 + 0.1 * static_cast<double>(i), 3e-7);
  }
  // Without the date the rate of the images tells, and the user may know better.
  EXPECT_THAT(pack(stampedCsv(0, 100), {}).out,
              HasSubstr("taken for milliseconds: 0.1 s lie between images"));
  EXPECT_THAT(pack(stampedCsv(0, 100), {}).out, HasSubstr("in s it would be 100 s"));
  EXPECT_EQ(pack(stampedCsv(0, 100), {"--stamp-unit", "s"}).code, kOk);
  EXPECT_EQ(framesOf(path("a.rawlog"))[5].stamp, 500.0);
  EXPECT_EQ(pack(stampedCsv(0, 100), {"--stamp-unit", "h"}).code, kUsage);
  write("stamps.txt",
        "1700000000000\n1700000000100\n1700000000200\n1700000000300\n1700000000400\n1700000000500\n");
  EXPECT_EQ(
      run({"pack", "--images", path("in"), "--stamps", path("stamps.txt"), "--out", path("b.rawlog"), "-q"})
          .code,
      kOk);
  EXPECT_NEAR(framesOf(path("b.rawlog"))[5].stamp, 1.7e9 + 0.5, 3e-7);
}

TEST_F(RawlogTool, StampUnitWithoutStampsIsRefused) {
  makeImages("in", 1);
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--stamps", "names"}}) {
    std::vector<std::string> arguments{"pack",           "--images",     path("in"), "--out",
                                       path("a.rawlog"), "--stamp-unit", "ms"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = run(arguments);
    EXPECT_EQ(result.code, kError);
    EXPECT_THAT(result.err, HasSubstr("--stamp-unit is for --csv and for --stamps FILE"));
  }
}

TEST_F(RawlogTool, PackTellsOfAClockThatWasSetAndLosesNothing) {
  makeImages("in", 1);
  std::string csv = "image,stamp\n";
  for (const double start : {20.0, 1.7e9, 1.6e9})
    for (int i = 0; i < 12; ++i) csv += "p0.png," + std::to_string(start + 0.1 * i) + "\n";
  write("t.csv", csv);
  const RunResult result =
      run({"pack", "--images", path("in"), "--csv", path("t.csv"), "--out", path("a.rawlog"), "-q"});
  EXPECT_EQ(result.code, kOk) << result.err;
  EXPECT_THAT(result.out, HasSubstr("the clock leapt ahead by more than a year (1x)"));
  auto source = sources::openRawlog(path("a.rawlog"));
  std::size_t images = 0;
  while (source->next()) ++images;
  EXPECT_EQ(images, 36u);
  EXPECT_EQ(source->stats().imagesBadStamp, 0u);
}

TEST_F(RawlogTool, TheNamesOfImagesSurvivePackAndUnpack) {
  fs::create_directory(path("in"));
  fs::create_directory(path("in/more"));
  const std::vector<std::string> names{"IMG_41.png", "kitchen.png", "more/IMG_41.png", "a b 7.png"};
  std::string csv = "image,stamp\n";
  for (std::size_t i = 0; i < names.size(); ++i) {
    cv::imwrite(path("in/" + names[i]),
                cv::Mat(16, 16, CV_8UC1, cv::Scalar(40.0 * static_cast<double>(i + 1))));
    csv += names[i] + "," + std::to_string(i) + "\n";
  }
  write("t.csv", csv);
  ASSERT_EQ(
      run({"pack", "--images", path("in"), "--csv", path("t.csv"), "--out", path("a.rawlog"), "-q"}).code,
      kOk);
  const auto frames = framesOf(path("a.rawlog"));
  ASSERT_EQ(frames.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(frames[i].label, names[i]);
  ASSERT_EQ(run({"unpack", path("a.rawlog"), "--out", path("u"), "-q"}).code, kOk);
  for (const char* name : {"IMG_41.png", "kitchen.png", "000002_IMG_41.png", "a b 7.png"})
    EXPECT_TRUE(fs::exists(path(std::string("u/") + name))) << name;
  ASSERT_EQ(
      run({"pack", "--images", path("u"), "--csv", path("u/frames.csv"), "--out", path("b.rawlog"), "-q"})
          .code,
      kOk);
  EXPECT_EQ(framesOf(path("b.rawlog"))[3].label, "a b 7.png");
}

TEST_F(RawlogTool, NamesInARawlogDoNotLeadOutOfTheFolder) {
  sources::RawlogWriterParams params;
  params.file_names = true;
  sources::RawlogWriter writer(path("a.rawlog"), params);
  for (const std::string label : {"../../evil.png", "/tmp/evil2.png", "..", "a,b.png", "#c.png"}) {
    types::Frame frame;
    frame.stamp = static_cast<double>(writer.frames());
    frame.image = cv::Mat(16, 16, CV_8UC1, cv::Scalar(90));
    frame.label = label;
    writer.add(frame);
  }
  writer.close();
  ASSERT_EQ(run({"unpack", path("a.rawlog"), "--out", path("in/side/u"), "-q"}).code, kOk);
  std::set<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(path("in")))
    if (entry.is_regular_file()) files.insert(fs::relative(entry.path(), path("in/side/u")).string());
  EXPECT_EQ(files, (std::set<std::string>{"000002.png", "000003.png", "000004.png", "evil.png", "evil2.png",
                                          "frames.csv"}));
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
  EXPECT_TRUE(fs::exists(path("u/p1.png")));

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
