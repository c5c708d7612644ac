// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_camera.h"

#include "engram/base/error.h"
#include "engram/base/image_header.h"
#include "engram/base/text.h"
#include "engram/cameras/pinhole.h"

#include <algorithm>
#include <cmath>

namespace engram::bags {
namespace {

Eigen::Matrix3d rectificationOf(const RosCameraInfo& info) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(info.R.data());
}

bool isRotation(const Eigen::Matrix3d& R) { return (R * R.transpose()).isIdentity(1e-3); }

void takeDistortion(const RosCameraInfo& info, cameras::ImagePlaneParams& plane) {
  const auto& d = info.D;
  const auto zero = [](double k) { return k == 0; };
  if (std::all_of(d.begin(), d.end(), zero)) return;
  const bool more = d.size() > 5 && !std::all_of(d.begin() + 5, d.end(), zero);
  if (d.size() < 4 || more || (info.model != "plumb_bob" && info.model != "rational_polynomial"))
    throw base::Error("its distortion " + base::quoted(info.model) +
                      " is none of Engram's; calibrate with engram-rawlog calibrate --model unified");
  plane.k1 = d[0], plane.k2 = d[1], plane.p1 = d[2], plane.p2 = d[3];
  plane.k3 = d.size() > 4 ? d[4] : 0.0;
}

}  // namespace

cameras::CameraRig toRig(const RosCameraInfo& info, bool rectified) {
  if (!base::plausibleSize(info.width, info.height)) throw base::Error("it has no size that a camera has");
  cameras::ImagePlaneParams plane;
  const auto& m = rectified ? info.P : info.K;
  const std::size_t row = rectified ? 4 : 3;
  plane.fx = m[0], plane.cx = m[2], plane.fy = m[row + 1], plane.cy = m[row + 2];
  if (!rectified) plane.skew = m[1];
  const auto finite = [](double v) { return std::isfinite(v); };
  if (!std::all_of(m.begin(), m.end(), finite) || !std::all_of(info.D.begin(), info.D.end(), finite))
    throw base::Error("not all of it is numbers");
  if (!(plane.fx > 0 && plane.fy > 0)) throw base::Error("its focal length is 0: it was never calibrated");
  if (!rectified) takeDistortion(info, plane);
  const cv::Size size(static_cast<int>(info.width), static_cast<int>(info.height));
  return cameras::makeRig(std::make_shared<cameras::Pinhole>(size, plane));
}

std::optional<Eigen::Isometry3d> leftToRight(const RosCameraInfo& left, const RosCameraInfo& right,
                                             bool rectified) {
  const Eigen::Matrix3d R_l = rectificationOf(left), R_r = rectificationOf(right);
  if (!(right.P[0] > 0) || !(left.P[0] > 0) || (!rectified && !(isRotation(R_l) && isRotation(R_r))))
    return std::nullopt;
  const double baseline = left.P[3] / left.P[0] - right.P[3] / right.P[0];
  if (!std::isfinite(baseline) || baseline == 0) return std::nullopt;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  if (rectified) {
    T.translation().x() = baseline;
  } else {
    T.linear() = R_l.transpose() * R_r;
    T.translation() = R_l.transpose() * Eigen::Vector3d(baseline, 0, 0);
  }
  return T;
}

}  // namespace engram::bags
