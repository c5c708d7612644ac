// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stereo_import.h"

#include "engram/base/error.h"
#include "engram/cameras/pinhole.h"
#include "engram/cameras/rectifier.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

namespace engram::apps {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class StereoImport : public testing::Test {
 protected:
  StereoImport() {
    std::string name = (fs::temp_directory_path() / "engram_import_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~StereoImport() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::string errorOf(const std::string& files) const {
    try {
      importStereoRig(files, {1241, 376});
    } catch (const base::Error& e) {
      return e.what();
    }
    return "";
  }

 private:
  fs::path folder_;
};

std::string euroc(double x, const std::string& distortion = "radial-tangential",
                  const std::string& k = "[400, 401, 320, 240]") {
  return "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [0, 0, 1, 0.1,\n         -1, 0, 0, " +
         std::to_string(x) +
         ",\n         0, -1, 0, 0.3,\n         0.0, 0.0, 0.0, 1.0]\nresolution: [640, 480]\n"
         "camera_model: pinhole\nintrinsics: " +
         k + "\ndistortion_model: " + distortion + "\ndistortion_coefficients: [-0.2, 0.05, 0.001, -0.002]\n";
}

TEST_F(StereoImport, EurocBodyIsTheRobot) {
  const auto rig = importStereoRig(write("cam0.yaml", euroc(0)) + "," + write("cam1.yaml", euroc(-0.11)), {});
  ASSERT_TRUE(rig);
  EXPECT_TRUE(rig->left.T_robot_cam.translation().isApprox(Eigen::Vector3d(0.1, 0, 0.3)));
  // The body's -y is the camera's x: the right eye stands 11 cm along it.
  EXPECT_TRUE(rig->T_left_right().translation().isApprox(Eigen::Vector3d(0.11, 0, 0), 1e-9));
  const auto& plane = dynamic_cast<const cameras::Pinhole&>(*rig->right.camera).plane();
  EXPECT_EQ(plane.fy, 401);
  EXPECT_EQ(plane.k2, 0.05);
  EXPECT_EQ(plane.p2, -0.002);
}

TEST_F(StereoImport, KittiIsRectifiedAlready) {
  const auto rig = importStereoRig(
      write("calib.txt", "P0: 700 0 600 0 0 700 180 0 0 0 1 0\nP1: 700 0 600 -378 0 700 180 0 0 0 1 0\n"),
      {1241, 376});
  ASSERT_TRUE(rig);
  const cameras::Rectifier rectifier(*rig);
  EXPECT_TRUE(rectifier.identity());
  EXPECT_NEAR(rectifier.model().baseline, 0.54, 1e-9);
  EXPECT_EQ(rectifier.model().f, 700);
  EXPECT_EQ(rectifier.imageSize(), cv::Size(1241, 376));
}

TEST_F(StereoImport, OtherFilesAreLeftToOthers) {
  EXPECT_FALSE(importStereoRig(write("camera.ini", "[camera]\n"), {}));
}

TEST_F(StereoImport, MistakesAreNamed) {
  const std::string good = write("cam0.yaml", euroc(0));
  EXPECT_THAT(errorOf(good + "," + write("fish.yaml", euroc(0, "equidistant"))),
              HasSubstr("fish.yaml: camera_model 'pinhole' with distortion_model 'equidistant'"));
  EXPECT_THAT(errorOf(good + "," + write("k.yaml", euroc(0, "radial-tangential", "[400, 401]"))),
              HasSubstr("k.yaml: intrinsics: expected 4 numbers, found 2"));
  EXPECT_THAT(errorOf(good + ",gone.yaml"), HasSubstr("gone.yaml: cannot be opened"));
  EXPECT_THAT(errorOf(write("one.txt", "P0: 700 0 600 0 0 700 180 0 0 0 1 0\n")),
              HasSubstr("holds no two projections"));
}

}  // namespace
}  // namespace engram::apps
