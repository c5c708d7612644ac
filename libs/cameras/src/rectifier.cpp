// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/cameras/rectifier.h"

#include "engram/base/error.h"
#include "engram/cameras/pinhole.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>

namespace engram::cameras {
namespace {

constexpr double kSame = 1e-6;  // relative: what a file with six digits keeps

const ImagePlaneParams& planeOf(const CameraRig& rig, const std::string& side) {
  const auto* camera = dynamic_cast<const Pinhole*>(rig.camera.get());
  if (!camera)
    throw base::Error("stereo: the " + side + " camera is of the model " + rig.camera->model() +
                      "; only pinhole cameras can be rectified");
  if (camera->plane().skew != 0)
    throw base::Error("stereo: the " + side + " camera has skew, which rectification does not know");
  return camera->plane();
}

std::string text(cv::Size size) { return std::to_string(size.width) + "x" + std::to_string(size.height); }

void checkPlacement(const Eigen::Vector3d& t) {
  const std::string where = std::to_string(t.x()) + " " + std::to_string(t.y()) + " " + std::to_string(t.z());
  if (std::abs(t.x()) < std::max({std::abs(t.y()), std::abs(t.z()), 1e-6}))
    throw base::Error("stereo: the cameras do not stand side by side: the right one is at (" + where +
                      ") m in the frame of the left one (x right, y down, z forward)");
  if (t.x() < 0)
    throw base::Error("stereo: the right camera stands on the left of the left one, at (" + where +
                      ") m; are the two exchanged in the calibration?");
}

bool undistorted(const ImagePlaneParams& p) {
  return p.k1 == 0 && p.k2 == 0 && p.k3 == 0 && p.p1 == 0 && p.p2 == 0;
}

bool isRectified(const ImagePlaneParams& l, const ImagePlaneParams& r, const Eigen::Isometry3d& T) {
  const auto same = [](double a, double b) { return std::abs(a - b) <= kSame * std::max(1.0, std::abs(a)); };
  const Eigen::Vector3d t = T.translation() / T.translation().norm();
  return undistorted(l) && undistorted(r) && same(l.fx, l.fy) && same(l.fx, r.fx) && same(l.fy, r.fy) &&
         same(l.cx, r.cx) && same(l.cy, r.cy) && T.linear().isIdentity(kSame) && std::abs(t.y()) < kSame &&
         std::abs(t.z()) < kSame;
}

cv::Matx33d matrixOf(const ImagePlaneParams& p) { return {p.fx, 0, p.cx, 0, p.fy, p.cy, 0, 0, 1}; }
cv::Vec<double, 5> distortionOf(const ImagePlaneParams& p) { return {p.k1, p.k2, p.p1, p.p2, p.k3}; }

cv::Mat grey(const cv::Mat& image, cv::Size size, const std::string& side) {
  if (image.empty()) throw base::Error("stereo: the " + side + " image is missing");
  if (image.size() != size)
    throw base::Error("stereo: the " + side + " image has " + text(image.size()) +
                      " pixels, the calibration is for " + text(size));
  if (image.channels() == 1) return image;
  cv::Mat out;
  cv::cvtColor(image, out, cv::COLOR_BGR2GRAY);
  return out;
}

}  // namespace

Rectifier::Rectifier(const StereoRig& rig)
    : size_(rig.left.camera->imageSize()), T_robot_cam_(rig.left.T_robot_cam) {
  const ImagePlaneParams &left = planeOf(rig.left, "left"), &right = planeOf(rig.right, "right");
  if (rig.right.camera->imageSize() != size_)
    throw base::Error("stereo: the left camera is calibrated for " + text(size_) +
                      " pixels, the right one for " + text(rig.right.camera->imageSize()));
  const Eigen::Isometry3d T_left_right = rig.T_left_right();
  checkPlacement(T_left_right.translation());
  if (!isRectified(left, right, T_left_right)) {
    makeMaps(rig);
    return;
  }
  model_ = {left.fx, left.cx, left.cy, T_left_right.translation().x()};
  mask_ = rig.left.mask & rig.right.mask;
}

void Rectifier::makeMaps(const StereoRig& rig) {
  const ImagePlaneParams &left = planeOf(rig.left, "left"), &right = planeOf(rig.right, "right");
  const Eigen::Isometry3d T_right_left = rig.T_left_right().inverse();
  cv::Mat R, t, R1, R2, P1, P2, Q;
  cv::eigen2cv(Eigen::Matrix3d(T_right_left.linear()), R);
  cv::eigen2cv(Eigen::Vector3d(T_right_left.translation()), t);
  cv::stereoRectify(matrixOf(left), distortionOf(left), matrixOf(right), distortionOf(right), size_, R, t, R1,
                    R2, P1, P2, Q, cv::CALIB_ZERO_DISPARITY, 0.0, size_);
  cv::initUndistortRectifyMap(matrixOf(left), distortionOf(left), R1, P1, size_, CV_16SC2, mapLeft_,
                              fractionsLeft_);
  cv::initUndistortRectifyMap(matrixOf(right), distortionOf(right), R2, P2, size_, CV_16SC2, mapRight_,
                              fractionsRight_);
  const cv::Matx34d P(P1);
  model_ = {P(0, 0), P(0, 2), P(1, 2), rig.T_left_right().translation().norm()};
  Eigen::Matrix3d R_rect_left;
  cv::cv2eigen(R1, R_rect_left);
  T_robot_cam_.linear() = T_robot_cam_.linear() * R_rect_left.transpose();
  cv::Mat maskLeft, maskRight;
  cv::remap(rig.left.mask, maskLeft, mapLeft_, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  cv::remap(rig.right.mask, maskRight, mapRight_, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  mask_ = maskLeft & maskRight;
}

types::StereoPair Rectifier::operator()(const cv::Mat& left, const cv::Mat& right) const {
  types::StereoPair pair{grey(left, size_, "left"), grey(right, size_, "right")};
  if (identity()) return pair;
  types::StereoPair out;
  cv::remap(pair.left, out.left, mapLeft_, fractionsLeft_, cv::INTER_LINEAR);
  cv::remap(pair.right, out.right, mapRight_, fractionsRight_, cv::INTER_LINEAR);
  return out;
}

}  // namespace engram::cameras
