// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/cameras/camera_import.h"

#include "engram/base/error.h"
#include "engram/cameras/pinhole.h"
#include "engram/cameras/rectifier.h"

#include <gmock/gmock.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/img/TCamera.h>
#include <opencv2/core.hpp>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace engram::cameras {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
namespace fs = std::filesystem;

class CameraImport : public testing::Test {
 protected:
  CameraImport() {
    std::string name = (fs::temp_directory_path() / "engram_import_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~CameraImport() override {
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

TEST_F(CameraImport, EurocBodyIsTheRobot) {
  const auto rig = importStereoRig(write("cam0.yaml", euroc(0)) + "," + write("cam1.yaml", euroc(-0.11)), {});
  ASSERT_TRUE(rig);
  EXPECT_TRUE(rig->left.T_robot_cam.translation().isApprox(Eigen::Vector3d(0.1, 0, 0.3)));
  // The body's -y is the camera's x: the right eye stands 11 cm along it.
  EXPECT_TRUE(rig->T_left_right().translation().isApprox(Eigen::Vector3d(0.11, 0, 0), 1e-9));
  const auto& plane = dynamic_cast<const Pinhole&>(*rig->right.camera).plane();
  EXPECT_EQ(plane.fy, 401);
  EXPECT_EQ(plane.k2, 0.05);
  EXPECT_EQ(plane.p2, -0.002);
}

TEST_F(CameraImport, KittiIsRectifiedAlready) {
  const auto rig = importStereoRig(
      write("calib.txt", "P0: 700 0 600 0 0 700 180 0 0 0 1 0\nP1: 700 0 600 -378 0 700 180 0 0 0 1 0\n"),
      {1241, 376});
  ASSERT_TRUE(rig);
  const Rectifier rectifier(*rig);
  EXPECT_TRUE(rectifier.identity());
  EXPECT_NEAR(rectifier.model().baseline, 0.54, 1e-9);
  EXPECT_EQ(rectifier.model().f, 700);
  EXPECT_EQ(rectifier.imageSize(), cv::Size(1241, 376));
}

TEST_F(CameraImport, KittiCamerasAreChosenByName) {
  const std::string file = write("calib.txt",
                                 "P0: 700 0 600 0 0 700 180 0 0 0 1 0\n"
                                 "P1: 700 0 600 -378 0 700 180 0 0 0 1 0\n"
                                 "P2: 710 0 601 42.6 0 710 181 0 0 0 1 0\n"
                                 "P3: 710 0 601 -340.8 0 710 181 0 0 0 1 0\n"
                                 "Tr: 1 0 0 0 0 1 0 0 0 0 1 0\n");
  const auto colour = importStereoRig(file + ":P2", {1241, 376});
  ASSERT_TRUE(colour);
  EXPECT_NEAR(Rectifier(*colour).model().baseline, 0.54, 1e-9);
  EXPECT_NEAR(colour->left.T_robot_cam.translation().x(), -0.06, 1e-9);
  EXPECT_FALSE(importStereoRig(file + ":P3", {1241, 376})) << "nothing stands right of it";
  const CameraRig one = importCamera(file + ":P2", {1241, 376});
  EXPECT_EQ(dynamic_cast<const Pinhole&>(*one.camera).plane().fx, 710);
  EXPECT_TRUE(one.T_robot_cam.isApprox(defaultMount("pinhole")));
}

const char* const kRos =
    "image_width: 640\nimage_height: 480\ncamera_name: narrow\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
    "  data: [438.78, 0.0, 305.59, 0.0, 437.3,\n         243.7, 0., 0., 1.]\ndistortion_model: plumb_bob\n"
    "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.36, 0.11, 0.0011, 0.0005, -0.01]\n";

TEST_F(CameraImport, RosAsTheCalibratorWritesIt) {
  const std::string file = write("left.yaml", kRos);
  const CameraRig rig = loadCamera(file);
  const ImagePlaneParams plane{.fx = 438.78,
                               .fy = 437.3,
                               .cx = 305.59,
                               .cy = 243.7,
                               .k1 = -0.36,
                               .k2 = 0.11,
                               .k3 = -0.01,
                               .p1 = 0.0011,
                               .p2 = 0.0005};
  EXPECT_EQ(dynamic_cast<const Pinhole&>(*rig.camera).plane(), plane);
  EXPECT_EQ(rig.camera->imageSize(), cv::Size(640, 480));
  EXPECT_TRUE(rig.T_robot_cam.isApprox(defaultMount("pinhole")));
  EXPECT_FALSE(describesStereo(file));
}

TEST_F(CameraImport, RosAsItIsEchoed) {
  const std::string file = write(
      "info.yaml",
      "header:\n  seq: 7\n  frame_id: \"eye\"\nheight: 480\nwidth: 640\ndistortion_model: \"plumb_bob\"\n"
      "D: [0.1, 0.2, 0.0, 0.0, 0.0]\nK: [500.0, 0.0, 320.0, 0.0, 501.0, 240.0, 0.0, 0.0, 1.0]\n"
      "R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n"
      "P: [500.0, 0.0, 320.0, 0.0, 0.0, 501.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0]\nbinning_x: 0\n---\n");
  const CameraRig rig = loadCamera(file);
  EXPECT_EQ(dynamic_cast<const Pinhole&>(*rig.camera).plane().fy, 501);
  EXPECT_EQ(dynamic_cast<const Pinhole&>(*rig.camera).plane().k2, 0.2);
}

/// A camera of a pair as ROS has it: how it is turned into the rectified pair, and P.
std::string rosEye(const Eigen::Matrix3d& R, double Tx) {
  std::ostringstream text;
  text.precision(17);
  text << kRos << "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [";
  for (int i = 0; i < 9; ++i) text << (i > 0 ? ", " : "") << R(i / 3, i % 3);
  text << "]\nprojection_matrix:\n  rows: 3\n  cols: 4\n  data: [400.0, 0.0, 320.0, " << Tx
       << ", 0.0, 400.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0]\n";
  return text.str();
}

TEST_F(CameraImport, RosPairStandsAsItsRectificationSays) {
  const Eigen::Matrix3d left =
      Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Eigen::Matrix3d right =
      Eigen::AngleAxisd(-0.03, Eigen::Vector3d(3, -1, 1).normalized()).toRotationMatrix();
  write("r.yaml", rosEye(right, -48.0));
  const auto rig = importStereoRig(write("l.yaml", rosEye(left, 0.0)) + ",r.yaml");
  ASSERT_TRUE(rig);
  // The truth: one point, seen by both eyes and in the rectified pair.
  const Eigen::Vector3d inRectifiedLeft(0.3, -0.2, 2.0),
      inRectifiedRight = inRectifiedLeft - Eigen::Vector3d(0.12, 0, 0);
  const Eigen::Vector3d inLeft = left.transpose() * inRectifiedLeft,
                        inRight = right.transpose() * inRectifiedRight;
  EXPECT_TRUE((rig->T_left_right() * inRight).isApprox(inLeft, 1e-9));
}

TEST_F(CameraImport, OpenCvAsItsFileStorageWritesIt) {
  for (const std::string ending : {".yaml", ".xml"}) {
    const std::string file = write("camera" + ending, "");
    cv::FileStorage out(file, cv::FileStorage::WRITE);
    out << "image_width" << 800 << "image_height" << 600;
    out << "camera_matrix" << cv::Mat(cv::Matx33d(600, 0.5, 400, 0, 610, 300, 0, 0, 1));
    out << "distortion_coefficients" << cv::Mat(cv::Matx<double, 5, 1>(0.1, -0.05, 1e-3, 2e-3, 0.01));
    if (ending == ".yaml") out << "xi" << 1.2;
    out.release();
    const CameraRig rig = loadCamera(file);
    EXPECT_EQ(rig.camera->model(), ending == ".yaml" ? "unified_sphere" : "pinhole");
    if (ending == ".yaml") continue;
    const ImagePlaneParams plane{.fx = 600,
                                 .fy = 610,
                                 .cx = 400,
                                 .cy = 300,
                                 .skew = 0.5,
                                 .k1 = 0.1,
                                 .k2 = -0.05,
                                 .k3 = 0.01,
                                 .p1 = 1e-3,
                                 .p2 = 2e-3};
    EXPECT_EQ(dynamic_cast<const Pinhole&>(*rig.camera).plane(), plane);
  }
}

TEST_F(CameraImport, MrptAsItWritesOneCamera) {
  mrpt::img::TCamera camera;
  camera.ncols = 640;
  camera.nrows = 480;
  camera.setIntrinsicParamsFromValues(500, 510, 320, 240);
  camera.setDistortionPlumbBob(0.1, -0.05, 1e-3, 2e-3, 0.01);
  mrpt::config::CConfigFileMemory file;
  camera.saveToConfigFile("CAMERA_PARAMS", file);
  const CameraRig rig = loadCamera(write("mrpt.ini", file.getContent() + "[mount]\nz = 1.5\n"));
  const ImagePlaneParams plane{
      .fx = 500, .fy = 510, .cx = 320, .cy = 240, .k1 = 0.1, .k2 = -0.05, .k3 = 0.01, .p1 = 1e-3, .p2 = 2e-3};
  EXPECT_EQ(dynamic_cast<const Pinhole&>(*rig.camera).plane(), plane);
  EXPECT_EQ(rig.camera->imageSize(), cv::Size(640, 480));
  EXPECT_EQ(rig.T_robot_cam.translation(), Eigen::Vector3d(0, 0, 1.5));
}

TEST_F(CameraImport, OwnFilesAreNotForeign) {
  EXPECT_FALSE(isForeignCalibration("camera.ini"));
  EXPECT_TRUE(isForeignCalibration("cam0.yaml,cam1.yaml"));
  EXPECT_TRUE(isForeignCalibration("calib.txt:P2"));
}

TEST_F(CameraImport, MistakesAreNamed) {
  const std::string good = write("cam0.yaml", euroc(0));
  EXPECT_THAT(errorOf(good + "," + write("fish.yaml", euroc(0, "equidistant"))),
              HasSubstr("fish.yaml: camera_model 'pinhole' with distortion_model 'equidistant'"));
  EXPECT_THAT(errorOf(good + "," + write("k.yaml", euroc(0, "radial-tangential", "[400, 401]"))),
              HasSubstr("k.yaml: intrinsics: expected 4 numbers, found 2"));
  EXPECT_THAT(errorOf(good + ",gone.yaml"), HasSubstr("gone.yaml: cannot be opened"));
  for (const char* text : {"- 1\n- 2\n", "7\n", "a word\n", "[camera]\nmo - 960rmo = 960re\nwd",
                           "a: 1\nb:\n  : 2\n  c: 5\n", "%YAML:1.0\n---\n- [1, 2]\n"})
    EXPECT_THAT([&] { importCamera(write("list.yaml", text)); }, ::testing::Throws<base::ConfigError>())
        << text;
  for (const char* width : {"1e300", "-4", "0", ".Nan", ".Inf"})
    EXPECT_THAT(
        [&] {
          importCamera(write("w.yaml", "image_width: " + std::string(width) +
                                           "\nimage_height: 480\nK: [400, 0, 9, 0, 400, 9, 0, 0, 1]\n"));
        },
        ::testing::Throws<base::ConfigError>())
        << width;
  const std::string one = write("one.txt", "P0: 700 0 600 0 0 700 180 0 0 0 1 0\n");
  EXPECT_THAT([&] { loadStereoRig(good); },
              ThrowsMessage<base::ConfigError>(HasSubstr("describes one camera")));
  EXPECT_THAT([&] { loadCamera(one); },
              ThrowsMessage<base::ConfigError>(HasSubstr("does not tell the size")));
  EXPECT_THAT(errorOf(one + ":P7"), HasSubstr("has no projection 'P7', but P0"));
  EXPECT_THAT(errorOf(write("none.txt", "Tr: 1 2 3\n")), HasSubstr("holds no projection"));
  EXPECT_THAT(errorOf(write("l.yaml", kRos) + "," + write("r.yaml", kRos)),
              HasSubstr("where the right camera is"));
  EXPECT_THAT([&] { loadCamera(write("size.yaml", "camera_matrix: [1, 0, 1, 0, 1, 1, 0, 0, 1]\n")); },
              ThrowsMessage<base::ConfigError>(HasSubstr("for which size is it?")));
}

}  // namespace
}  // namespace engram::cameras
