// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Runs on images as they are: files, videos, parts of a drive, with the calibration that comes with them, and
// with the configuration that a map holds.
#include "../sources/rawlog_fixture.h"
#include "engram/cameras/camera_rig.h"
#include "engram/store/map_file.h"
#include "report_pictures.h"
#include "run_fixture.h"

#include <gmock/gmock.h>
#include <mrpt/obs/CObservationImage.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <filesystem>

namespace engram::apps {
namespace {

namespace fs = std::filesystem;
namespace raw = sources::test;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class ImagesRunTest : public RunTest {
 protected:
  /// The first images of the first drive as files at_9.png, at_10.png, …
  std::string imageFolder(std::size_t n) const {
    fs::create_directory(path("walk"));
    std::size_t number = 9;
    for (const auto& frame : firstFrames(n))
      cv::imwrite(path("walk/at_" + std::to_string(number++) + ".png"), frame.image);
    return path("walk");
  }
  std::vector<types::FrameReport> records(const std::string& map) const {
    return store::MapFile::open(map, store::Access::kReadOnly).records();
  }
  static std::string cameraOf(const std::string& map) {
    return store::MapFile::open(map, store::Access::kReadOnly).header().camera;
  }
  static std::vector<std::string> labels(const std::vector<types::FrameReport>& records) {
    std::vector<std::string> labels;
    for (const auto& r : records) labels.push_back(r.label);
    return labels;
  }
  /// A rawlog of calibrated images of 320 x 240, with fx = 222.
  std::string calibratedRawlog() const {
    raw::Objects objects;
    for (int i = 0; i < 3; ++i) {
      const auto object = std::dynamic_pointer_cast<mrpt::obs::CObservationImage>(
          raw::imageObject(raw::kStart + i, raw::picture(i, {320, 240})));
      object->cameraParams.ncols = 320;
      object->cameraParams.nrows = 240;
      object->cameraParams.setIntrinsicParamsFromValues(222, 223, 160, 120);
      objects.push_back(object);
    }
    raw::writeWithMrpt(path("own.rawlog"), objects, true);
    return path("own.rawlog");
  }
};

TEST_F(ImagesRunTest, AFolderOfImagesIsADriveAndKeepsItsNames) {
  const RunResult run = slam({config(), "--images", imageFolder(4), "-q"});
  ASSERT_EQ(run.code, kOk) << run.err;
  EXPECT_THAT(labels(records(path("walk.engram"))),
              ElementsAre("at_9.png", "at_10.png", "at_11.png", "at_12.png"));
  const RunResult found = localize(
      {"--map", path("walk.engram"), "--images", path("walk") + "/", "--out", path("found.csv"), "-q"});
  ASSERT_EQ(found.code, kOk) << found.err;
  EXPECT_THAT(bytesOf(path("found.csv")), HasSubstr("at_12.png"));
}

TEST_F(ImagesRunTest, APartOfADrive) {
  const RunResult run = slam({config(), "--rawlog", rawlog(1), "--map", path("part.engram"), "--from", "2",
                              "--to", "7", "--every", "2", "-q"});
  ASSERT_EQ(run.code, kOk) << run.err;
  std::vector<std::uint64_t> numbers;
  for (const auto& r : records(path("part.engram"))) numbers.push_back(r.index);
  EXPECT_THAT(numbers, ElementsAre(2, 4, 6));
  const RunResult beyond =
      slam({config(), "--rawlog", rawlog(1), "--map", path("x.engram"), "--from", "5000", "-q"});
  EXPECT_EQ(beyond.code, kError);
  EXPECT_THAT(beyond.err, HasSubstr("none from number 5000 on"));
  EXPECT_EQ(slam({config(), "--rawlog", rawlog(1), "--from", "5", "--to", "4"}).code, kUsage);
  EXPECT_EQ(slam({config(), "--rawlog", rawlog(1), "--images", path("")}).code, kUsage);
}

TEST_F(ImagesRunTest, AVideoIsADrive) {
  cv::VideoWriter video(path("v.avi"), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 5, {640, 480});
  for (const auto& frame : firstFrames(4)) video.write(frame.image);
  video.release();
  const RunResult run = slam({config(), "--video", path("v.avi"), "-q"});
  ASSERT_EQ(run.code, kOk) << run.err;
  const auto all = records(path("v.engram"));
  EXPECT_THAT(labels(all), ElementsAre("v.avi#0", "v.avi#1", "v.avi#2", "v.avi#3"));
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_NEAR(all[i].stamp - all[i - 1].stamp, 0.2, 1e-6);
  EXPECT_THAT(slam({config(), "--video", path("none.avi")}).err, HasSubstr("none.avi: no such video"));
  writeBytes(path("text.avi"), "this is no video");
  EXPECT_THAT(slam({config(), "--video", path("text.avi")}).err, HasSubstr("is no video that can be read"));
}

TEST_F(ImagesRunTest, TheCalibrationOfARawlogIsUsed) {
  const std::string own = calibratedRawlog(), mono = ENGRAM_SOURCE_DIR "/config/fsh_mono.ini";
  const RunResult run = slam({mono, "--rawlog", own, "--map", path("own.engram"), "-q"});
  ASSERT_EQ(run.code, kOk) << run.err;
  EXPECT_THAT(run.err, HasSubstr("camera: as " + own + " says"));
  const auto rig = cameras::parseCamera(cameraOf(path("own.engram")), "map");
  const auto bare = cameras::parseCamera(
      "[camera]\nmodel = pinhole\nwidth = 640\nheight = 480\nfx = 444\nfy = 446\n"
      "cx = 320.5\ncy = 240.5\n",
      "truth");
  EXPECT_EQ(cameras::toText(rig), cameras::toText(bare)) << "scaled to the width of the configuration";

  // Also where the configuration has only the simulator's camera; but what the user names goes before.
  const std::string simulators = ENGRAM_SOURCE_DIR "/config/words_odometry.ini";
  EXPECT_EQ(slam({simulators, "--rawlog", own, "--map", path("s.engram"), "-q"}).code, kOk);
  EXPECT_THAT(cameraOf(path("s.engram")), HasSubstr("fx = 222"));
  writeBytes(path("mine.ini"), "[camera]\nmodel = pinhole\nwidth = 320\nheight = 240\nfov_deg = 70\n");
  const RunResult named = slam({mono, "--rawlog", own, "--camera", path("mine.ini"), "--map",
                                path("n.engram"), "-q", "--set", "camera.image_width=0"});
  EXPECT_EQ(named.code, kOk) << named.err;
  EXPECT_THAT(cameraOf(path("n.engram")), Not(HasSubstr("fx = 222")));
}

TEST_F(ImagesRunTest, TheReportShowsWhatWasRecognisedBesideItsPlace) {
  const RunResult run = slam(
      {config(), "--rawlog", rawlog(2), "--map", mapCopy(), "--extend", "--report", path("report"), "-q"});
  ASSERT_EQ(run.code, kOk) << run.err;
  const std::string page = bytesOf(path("report/index.html"));
  std::size_t pictures = 0;
  for (auto at = page.find("src=\"data:image/jpeg"); at != std::string::npos;
       at = page.find("src=\"", at + 1))
    ++pictures;
  EXPECT_GE(pictures, 10u);
  EXPECT_LE(pictures, 2 * 24u);
  EXPECT_EQ(pictures % 2, 0u);
  EXPECT_THAT(page, HasSubstr("matches agree with one motion of the camera"));
}

/// However long the drive is, from its beginning to its end.
TEST(ReportPictures, AreSomeAllAlongTheDrive) {
  ReportPictures pictures;
  types::Frame frame;
  frame.image = cv::Mat(30, 40, CV_8U, cv::Scalar(90));
  types::FrameReport report;
  report.outcome = types::Outcome::kRecognised;
  for (report.index = 0; report.index < 10000; ++report.index) pictures.add(report, frame);
  const auto all = pictures.all();
  EXPECT_LE(all.size(), ReportPictures::kMost);
  EXPECT_GE(all.size(), ReportPictures::kMost / 2);
  EXPECT_EQ(all.begin()->first.first, 0u);
  EXPECT_GT(all.rbegin()->first.first, 9000u);
}

TEST_F(ImagesRunTest, CalibrationsOfOthersAreRead) {
  const std::string folder = imageFolder(2);
  writeBytes(path("calib.txt"), "P0: 500 0 320 0 0 500 240 0 0 0 1 0\nP2: 510 0 320 0 0 510 240 0 0 0 1 0\n");
  const std::string mono = ENGRAM_SOURCE_DIR "/config/fsh_mono.ini";
  const RunResult run = slam(
      {mono, "--images", folder, "--camera", path("calib.txt") + ":P2", "--map", path("k.engram"), "-q"});
  ASSERT_EQ(run.code, kOk) << run.err;
  EXPECT_THAT(cameraOf(path("k.engram")), AllOf(HasSubstr("fx = 510"), HasSubstr("width = 640")));
  EXPECT_THAT(store::MapFile::open(path("k.engram"), store::Access::kReadOnly).header().parameters,
              HasSubstr("file = " + path("calib.txt") + ":P2\n"));
}

TEST_F(ImagesRunTest, AMapKnowsItsConfigurationAndItsCamera) {
  writeBytes(path("eye.ini"), bytesOf(ENGRAM_SOURCE_DIR "/share/cameras/omni_world.ini"));
  writeBytes(path("robot.ini"), "[camera]\nfile = eye.ini\n[extractor]\nmax_features = 300\n");
  ASSERT_EQ(slam({path("robot.ini"), "--rawlog", rawlog(1), "--map", path("m.engram"), "-q"}).code, kOk);
  constexpr int kMilliseconds = 14;  // the column that differs
  const auto located = [&](std::vector<std::string> with, const std::string& csv) {
    with.insert(with.end(), {"--map", path("m.engram"), "--rawlog", rawlog(2), "--out", path(csv), "-q"});
    const RunResult run = localize(with);
    EXPECT_EQ(run.code, kOk) << run.err;
    std::string text;
    int column = 0;
    for (const char c : bytesOf(path(csv))) {
      column = c == '\n' ? 0 : column + (c == ',');
      if (column != kMilliseconds) text += c;
    }
    return text;
  };
  const std::string with = located({path("robot.ini")}, "with.csv");
  fs::remove(path("eye.ini"));
  EXPECT_EQ(located({}, "without.csv"), with);
  EXPECT_EQ(slam({"--rawlog", rawlog(2), "--map", path("m.engram"), "--extend", "-q"}).code, kOk);
  EXPECT_THAT(localize({"--map", path("m.engram"), "--dump-config"}).out, HasSubstr("max_features = 300"));
  const RunResult none = slam({"--rawlog", rawlog(1), "--map", path("new.engram")});
  EXPECT_EQ(none.code, kUsage);
  EXPECT_THAT(none.err, HasSubstr("a configuration is missing"));
}

}  // namespace
}  // namespace engram::apps
