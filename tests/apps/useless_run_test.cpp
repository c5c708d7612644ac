// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
// Runs that do not work as hoped must not look like a success.
#include "engram/cameras/stereo_rig.h"
#include "engram/store/map_file.h"
#include "run_fixture.h"
#include "stereo_drive.h"

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace engram::apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
namespace fs = std::filesystem;

using Frames = std::vector<types::Frame>;

cv::Mat dark(const cv::Mat& image) { return {image.size(), image.type(), cv::Scalar::all(7)}; }

std::string contentOf(const std::string& map) {
  std::ostringstream text;
  store::MapFile::open(map, store::Access::kReadOnly).dump(text);
  return text.str();
}

class UselessRunTest : public RunTest {
 protected:
  /// A configuration of maps of views for the small stereo camera, or for another calibration.
  std::string viewConfig(const std::string& camera = engram::testing::stereoParams().camera.file) const {
    std::ofstream(path("view.ini")) << "[mapping]\nnodes = views\n[camera]\nfile = " << camera
                                    << "\nstereo = true\n[extractor]\nupright = true\n[memory]\nmemory = "
                                       "static\n[posegraph]\nplanar = false\n[views]\nmin_interval = 0.3\n";
    return path("view.ini");
  }
  static Frames stereoFrames() { return engram::testing::firstStereoDrive().frames; }

  RunResult map(const std::string& config, const Frames& frames, std::vector<std::string> more = {}) const {
    fs::remove(path("drive.rawlog"));
    writeRawlog(path("drive.rawlog"), frames);
    std::vector<std::string> arguments{config,           "--rawlog", path("drive.rawlog"), "--map",
                                       path("m.engram"), "--json",   path("m.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return slam(arguments);
  }
};

TEST_F(UselessRunTest, ASoundStereoCameraIsMappedWithoutAWord) {
  const RunResult result = map(viewConfig(), stereoFrames(), {"-q"});
  EXPECT_EQ(result.code, kOk);
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_GE(jsonOf(path("m.json"))["views"], 5);
}

TEST_F(UselessRunTest, SingleImagesForAStereoCameraMakeNoMap) {
  Frames frames = stereoFrames();
  for (auto& frame : frames) frame.right.release();
  const RunResult result = map(viewConfig(), frames);
  EXPECT_EQ(result.code, kError);
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("none of 60 images could be used"),
                    HasSubstr("the right image of the stereo camera is missing"), HasSubstr("right_label")));
  EXPECT_FALSE(fs::exists(path("m.engram")));
}

/// Nor do they replace or change one.
TEST_F(UselessRunTest, AMapSurvivesADriveOfWhichNothingCanBeUsed) {
  ASSERT_EQ(map(viewConfig(), stereoFrames(), {"-q"}).code, kOk);
  const std::string before = contentOf(path("m.engram"));
  Frames frames = stereoFrames();
  for (auto& frame : frames) frame.right.release();
  for (const char* how : {"--overwrite", "--extend"}) {
    EXPECT_EQ(map(viewConfig(), frames, {how}).code, kError) << how;
    EXPECT_TRUE(contentOf(path("m.engram")) == before) << how;
  }
}

TEST_F(UselessRunTest, ImagesOfAnotherSizeAreNamed) {
  Frames frames = firstFrames(7);
  for (std::size_t i = 2; i < frames.size(); ++i) frames[i].image = frames[i].image(cv::Rect(0, 0, 320, 240));
  const RunResult result = map(config(), frames);
  EXPECT_EQ(result.code, kPartial);
  const std::string cause = "the image is 320x240, the camera of the configuration 640x480";
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("5 of 7 images were of no use: " + cause), HasSubstr("[camera] file")));
  EXPECT_THAT(result.out, HasSubstr("of no use: 5 (" + cause + ")"));
  EXPECT_EQ(jsonOf(path("m.json"))["causes"], (nlohmann::json{{cause, 5}}));
  EXPECT_EQ(soundImages(path("m.engram")), 7u);
}

/// What came before the first image of use is in the map all the same.
TEST_F(UselessRunTest, DarkImagesAtTheStartAreRecorded) {
  Frames frames = firstFrames(8);
  for (std::size_t i = 0; i < 3; ++i) frames[i].image = dark(frames[i].image);
  const RunResult result = map(config(), frames, {"-q"});
  EXPECT_EQ(result.code, kOk) << result.err;
  EXPECT_EQ(jsonOf(path("m.json"))["causes"], (nlohmann::json{{"too few features", 3}}));
  EXPECT_EQ(soundImages(path("m.engram")), 8u);
  const auto file = store::MapFile::open(path("m.engram"), store::Access::kReadOnly);
  EXPECT_NEAR(file.header().firstStamp, frames[0].stamp, 1e-6);
  EXPECT_EQ(file.records().front().reason, "too few features");
}

TEST_F(UselessRunTest, AWrongCalibrationIsFoundWhileMapping) {
  cameras::StereoRig wrong = cameras::loadStereoRig(engram::testing::stereoParams().camera.file);
  wrong.right.T_robot_cam = wrong.right.T_robot_cam * Eigen::AngleAxisd(0.08, Eigen::Vector3d::UnitX());
  std::ofstream(path("wrong.ini")) << cameras::toText(wrong);
  const RunResult result = map(viewConfig(path("wrong.ini")), stereoFrames());
  EXPECT_THAT(result.code, ::testing::AnyOf(kPartial, kError));
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("not rectified by this calibration"), HasSubstr("calibrate again")));
  EXPECT_EQ(result.code == kError, !fs::exists(path("m.engram")));
  EXPECT_THAT(result.err, HasSubstr("visual odometry failed"));
}

TEST_F(UselessRunTest, FaultsOfTheEyesAreFoundWhileMapping) {
  const Frames sound = stereoFrames();
  Frames swapped = sound, covered = sound, late = sound;
  for (auto& frame : swapped) std::swap(frame.image, frame.right);
  for (auto& frame : covered) frame.right = dark(frame.right);
  for (std::size_t i = 1; i < sound.size(); ++i) late[i].right = sound[i - 1].right;
  for (const auto& [frames, fault] :
       {std::pair(&swapped, "left and right are swapped"), std::pair(&covered, "the right eye shows nothing"),
        std::pair(&late, "the eyes are out of step")}) {
    const RunResult result = map(viewConfig(), *frames, {"--overwrite"});
    EXPECT_THAT(result.code, ::testing::AnyOf(kPartial, kError)) << fault;
    EXPECT_THAT(result.err, HasSubstr(fault));
  }
}

TEST_F(UselessRunTest, LocalisingWithoutUseIsAnErrorAndTeachesNothing) {
  const std::string file = mapCopy(), before = contentOf(file);
  Frames frames = firstFrames(5);
  for (auto& frame : frames) frame.image = dark(frame.image);
  writeRawlog(path("dark.rawlog"), frames);
  for (const bool adapt : {false, true}) {
    std::vector<std::string> arguments{config(), "--map", file, "--rawlog", path("dark.rawlog")};
    if (adapt) arguments.push_back("--adapt");
    const RunResult result = localize(arguments);
    EXPECT_EQ(result.code, kError);
    EXPECT_THAT(result.err, HasSubstr("none of 5 images could be used; the cause of 5: too few features"));
    EXPECT_TRUE(contentOf(file) == before);
  }
}

TEST_F(UselessRunTest, MostlyDarkImagesAreNotLocalisedInSilence) {
  Frames frames = firstFrames(9);
  for (std::size_t i = 3; i < frames.size(); ++i) frames[i].image = dark(frames[i].image);
  writeRawlog(path("dark.rawlog"), frames);
  const RunResult result =
      localize({config(), "--map", firstMap(), "--rawlog", path("dark.rawlog"), "--json", path("l.json")});
  EXPECT_EQ(result.code, kPartial);
  EXPECT_THAT(result.err, HasSubstr("6 of 9 images were of no use: too few features"));
  EXPECT_THAT(result.out, HasSubstr("of no use: "));
  EXPECT_EQ(jsonOf(path("l.json"))["causes"]["too few features"], 6);
}

}  // namespace
}  // namespace engram::apps
