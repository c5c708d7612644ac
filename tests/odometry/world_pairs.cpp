// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "world_pairs.h"

#include "engram/cameras/pinhole.h"
#include "engram/world/world.h"

#include <opencv2/imgproc.hpp>

namespace engram::odometry::testing_world {
namespace {

const world::World& office() {
  static const world::World world = world::World::preset("office", {});
  return world;
}

const world::Scene& scene() {
  static const world::Appearance appearance = office().appearance(1);  // the scene refers to it
  static const world::Scene scene(office().building(), appearance, office().library(), 2);
  return scene;
}

cv::Mat grey(const cv::Mat& image) {
  cv::Mat out;
  cv::cvtColor(image, out, cv::COLOR_BGR2GRAY);
  return out;
}

}  // namespace

cameras::StereoRig smallRig() {
  auto [left, right] = cameras::loadStereoRig(ENGRAM_SOURCE_DIR "/share/cameras/stereo_world.ini");
  const auto shrink = [](const cameras::CameraRig& rig) {
    cameras::CameraRig small = cameras::makeRig(rig.camera->scaled(0.5, 0.5));
    small.T_robot_cam = rig.T_robot_cam;
    return small;
  };
  return {shrink(left), shrink(right)};
}

cameras::StereoRig crookedRig() {
  cameras::StereoRig rig = smallRig();
  cameras::ImagePlaneParams left{.fx = 205, .fy = 204, .cx = 163, .cy = 118};
  left.k1 = -0.21, left.k2 = 0.04, left.p1 = 4e-4;
  cameras::ImagePlaneParams right{.fx = 203, .fy = 203.5, .cx = 156, .cy = 124};
  right.k1 = -0.2, right.k2 = 0.038, right.p2 = -3e-4;
  rig.left.camera = std::make_shared<cameras::Pinhole>(cv::Size(320, 240), left);
  rig.right.camera = std::make_shared<cameras::Pinhole>(cv::Size(320, 240), right);
  const Eigen::AngleAxisd tilt(0.03, Eigen::Vector3d(1, 0.4, -0.8).normalized());
  rig.right.T_robot_cam = rig.right.T_robot_cam * tilt;
  return rig;
}

std::vector<Shown> driveThroughOffice(const cameras::StereoRig& rig, int frames, double step, double start) {
  const world::Renderer left(rig.left, {}), right(rig.right, {});
  std::vector<Shown> shown;
  for (int i = 0; i < frames; ++i) {
    Shown one;
    one.T_world_robot = types::toIsometry(office().route().at(start + i * step));
    const auto seed = static_cast<std::uint64_t>(2 * i);
    one.raw.left =
        grey(world::renderAt(scene(), left, one.T_world_robot * rig.left.T_robot_cam, {}, seed, 2));
    one.raw.right =
        grey(world::renderAt(scene(), right, one.T_world_robot * rig.right.T_robot_cam, {}, seed + 1, 2));
    shown.push_back(std::move(one));
  }
  return shown;
}

Rectified rectify(const cameras::StereoRig& rig, const std::vector<Shown>& shown) {
  Rectified out{cameras::Rectifier(rig), {}, {}};
  for (const auto& one : shown) {
    out.pairs.push_back(out.rectifier(one.raw.left, one.raw.right));
    out.T_world_cam.push_back(one.T_world_robot * out.rectifier.T_robot_cam());
  }
  return out;
}

}  // namespace engram::odometry::testing_world
