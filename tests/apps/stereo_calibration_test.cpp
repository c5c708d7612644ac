// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stereo_calibration.h"

#include "board_scene.h"
#include "engram/base/error.h"
#include "engram/cameras/pinhole.h"
#include "program_run.h"
#include "rawlog_program.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include <filesystem>
#include <fstream>
#include <numbers>

namespace engram::apps::stereo_calibration {
namespace {

using ::testing::HasSubstr;
using testing_board::kBoard;
using testing_board::kSquare;
namespace fs = std::filesystem;

const cv::Size kSize(320, 240);
constexpr double kDegree = std::numbers::pi / 180;
const CalibrationOptions kOptions{false, kBoard, kSquare, false};

/// Two ordinary lenses, 9 cm apart, not quite parallel.
cameras::StereoRig head() {
  cameras::ImagePlaneParams left{.fx = 205, .fy = 204, .cx = 163, .cy = 118};
  left.k1 = -0.21, left.k2 = 0.04, left.p1 = 4e-4;
  cameras::ImagePlaneParams right{.fx = 203, .fy = 203.5, .cx = 156, .cy = 124};
  right.k1 = -0.2, right.k2 = 0.038, right.p2 = -3e-4;
  const auto eye = [](const cameras::ImagePlaneParams& plane) {
    return cameras::makeRig(std::make_shared<cameras::Pinhole>(kSize, plane));
  };
  cameras::StereoRig rig{eye(left), eye(right)};
  rig.right.T_robot_cam = rig.left.T_robot_cam * Eigen::Translation3d(0.09, 1e-3, -2e-3) *
                          Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, 0.4, -0.8).normalized());
  return rig;
}

/// Poses of the board in the left camera that both eyes see whole.
std::vector<Eigen::Isometry3d> boards(const cameras::StereoRig& rig, int wanted) {
  base::Rng rng(7);
  std::vector<Eigen::Isometry3d> found;
  for (int i = 0; static_cast<int>(found.size()) < wanted; ++i) {
    const auto T =
        testing_board::boardPose(2.4 * i, 0.35 * std::sqrt(rng.uniform()), rng.uniform(0.4, 0.7), rng);
    const auto seen = [&](const cameras::Camera& camera, const Eigen::Isometry3d& T_camera_board) {
      for (const double x : {-1.5, 9.5})
        for (const double y : {-1.5, 6.5}) {
          const auto at = camera.project(T_camera_board * Eigen::Vector3d(x * kSquare, y * kSquare, 0));
          if (!at || at->x() < 2 || at->y() < 2 || at->x() > 317 || at->y() > 237) return false;
        }
      return true;
    };
    if (seen(*rig.left.camera, T) && seen(*rig.right.camera, rig.T_left_right().inverse() * T))
      found.push_back(T);
  }
  return found;
}

std::vector<cv::Point2f> corners(const cameras::Camera& camera, const Eigen::Isometry3d& T, base::Rng& rng,
                                 double noise) {
  std::vector<cv::Point2f> points;
  for (int row = 0; row < kBoard.height; ++row)
    for (int column = 0; column < kBoard.width; ++column) {
      const auto at = camera.project(T * Eigen::Vector3d(column * kSquare, row * kSquare, 0));
      points.emplace_back(static_cast<float>(at->x() + rng.normal(0, noise)),
                          static_cast<float>(at->y() + rng.normal(0, noise)));
    }
  return points;
}

std::vector<BoardPair> pairs(const cameras::StereoRig& rig, int wanted, double noise) {
  base::Rng rng(11);
  std::vector<BoardPair> out;
  for (const auto& T : boards(rig, wanted))
    out.push_back({"pair " + std::to_string(out.size()), corners(*rig.left.camera, T, rng, noise),
                   corners(*rig.right.camera, rig.T_left_right().inverse() * T, rng, noise)});
  return out;
}

void expectHead(const cameras::StereoRig& is, double metres, double degrees) {
  const Eigen::Isometry3d error = head().T_left_right().inverse() * is.T_left_right();
  EXPECT_LT(error.translation().norm(), metres);
  EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), degrees * kDegree);
}

TEST(StereoCalibration, RecoversThePoseBetweenTheEyes) {
  const auto result = calibrateStereo(pairs(head(), 16, 0.1), kSize, kOptions);
  EXPECT_NEAR(result.rms, 0.1 * std::sqrt(2.0), 0.03);  // of the distance: two coordinates
  expectHead(result.rig, 1e-3, 0.25);
  EXPECT_LT(result.rowError, 0.2);
  EXPECT_LT(result.squareError, 1.5e-3);
}

TEST(StereoCalibration, ExactCornersGiveTheExactHead) {
  const auto result = calibrateStereo(pairs(head(), 12, 0), kSize, kOptions);
  EXPECT_LT(result.rms, 2e-3);
  expectHead(result.rig, 2e-5, 0.01);
  EXPECT_LT(result.rowError, 2e-3);
  EXPECT_LT(result.squareError, 2e-5);
}

TEST(StereoCalibration, APairOfDifferentMomentsIsLeftOut) {
  auto views = pairs(head(), 12, 0.1);
  views[4].right = views[5].right;
  const auto result = calibrateStereo(views, kSize, kOptions);
  EXPECT_FALSE(result.views[4].used);
  EXPECT_TRUE(result.views[5].used);
  expectHead(result.rig, 1.5e-3, 0.3);
}

TEST(StereoCalibration, TooFewPairsIsAnError) {
  EXPECT_THROW(calibrateStereo(pairs(head(), 4, 0.1), kSize, kOptions), base::Error);
}

RunResult run(const std::vector<std::string>& arguments) { return runAs<RawlogProgram>(arguments); }

/// Images of a board in `left` and `right` of a folder that goes away with the test.
class StereoCalibrate : public testing::Test {
 protected:
  StereoCalibrate() {
    std::string name = (fs::temp_directory_path() / "engram_stereo_XXXXXX").string();
    folder_ = mkdtemp(name.data());
    fs::create_directories(folder_ / "left");
    fs::create_directories(folder_ / "right");
  }
  ~StereoCalibrate() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void takePictures(int n) const {
    const auto rig = head();
    int i = 0;
    for (const auto& T : boards(rig, n)) {
      cv::imwrite(path(cv::format("left/%d.png", i)), testing_board::render(*rig.left.camera, T));
      cv::imwrite(path(cv::format("right/%d.png", i++)),
                  testing_board::render(*rig.right.camera, rig.T_left_right().inverse() * T));
    }
  }
  std::vector<std::string> command(const std::string& out, std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"calibrate",   "--stereo", "--images", path("left"), "--right",
                                   path("right"), "--board",  "9x6",      "--square",   "0.03",
                                   "--out",       path(out),  "-q"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

 private:
  fs::path folder_;
};

TEST_F(StereoCalibrate, FromPicturesToAFileThatAllProgramsRead) {
  takePictures(9);
  const auto result = run(command("head.ini", {"--json", path("head.json")}));
  ASSERT_EQ(result.code, kOk) << result.err;
  EXPECT_THAT(result.out, HasSubstr("baseline 0.09"));
  expectHead(cameras::loadStereoRig(path("head.ini")), 2e-3, 0.5);
  std::ifstream in(path("head.json"));
  const auto json = nlohmann::json::parse(in);
  EXPECT_NEAR(json["baseline_m"], 0.09, 1e-3);
  EXPECT_LT(json["row_rms_px"], 0.2);

  EXPECT_EQ(run(command("head.ini")).code, kError);  // exists
  ASSERT_EQ(run(command("mrpt.ini", {"--format", "mrpt"})).code, kOk);
  EXPECT_TRUE(cameras::loadStereoRig(path("mrpt.ini"))
                  .T_left_right()
                  .isApprox(cameras::loadStereoRig(path("head.ini")).T_left_right(), 1e-6));
}

TEST_F(StereoCalibrate, MistakesAreNamed) {
  for (const char* eye : {"left", "right"})
    cv::imwrite(path(std::string(eye) + "/1.png"), cv::Mat(kSize, CV_8U, cv::Scalar(90)));
  auto result = run(command("head.ini"));
  EXPECT_EQ(result.code, kError);
  EXPECT_THAT(result.err, HasSubstr("in 0 pairs of images; at least 5 are needed"));
  EXPECT_FALSE(fs::exists(path("head.ini")));
  cv::imwrite(path("right/1.png"), cv::Mat(120, 160, CV_8U, cv::Scalar(90)));
  EXPECT_THAT(run(command("head.ini")).err, HasSubstr("another size"));
  EXPECT_THAT(run({"calibrate", "--stereo", "--images", path("left"), "--board", "9x6", "--square", "0.03",
                   "--out", path("x.ini")})
                  .err,
              HasSubstr("--images LEFT --right RIGHT"));
  EXPECT_THAT(run(command("head.ini", {"--model", "unified"})).err, HasSubstr("ordinary lenses"));
}

}  // namespace
}  // namespace engram::apps::stereo_calibration
