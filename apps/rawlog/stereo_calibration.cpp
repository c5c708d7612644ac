// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stereo_calibration.h"

#include "engram/base/error.h"
#include "engram/cameras/pinhole.h"
#include "engram/cameras/rectifier.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include <algorithm>
#include <cmath>

namespace engram::apps {
namespace {

constexpr std::size_t kFewestViews = 5;
constexpr double kOutlierFactor = 2.5;  // times the median rms of the views
constexpr double kNeverOutlier = 0.3;   // [px]
constexpr int kRounds = 4;
constexpr double kApart = 5;  // times the median distance from the median pose of the right eye

/// One solution over some of the views.
struct Fit {
  cv::Mat K[2], D[2], R, t;
  std::vector<double> errors;  // rms of each view, both eyes [px]
};

std::vector<cv::Point3f> boardPoints(const CalibrationOptions& options) {
  std::vector<cv::Point3f> points;
  for (int row = 0; row < options.board.height; ++row)
    for (int column = 0; column < options.board.width; ++column)
      points.emplace_back(static_cast<float>(column * options.square),
                          static_cast<float>(row * options.square), 0.f);
  return points;
}

Fit fit(const std::vector<const BoardPair*>& views, cv::Size size, const CalibrationOptions& options) {
  const std::vector<std::vector<cv::Point3f>> objects(views.size(), boardPoints(options));
  std::vector<std::vector<cv::Point2f>> corners[2];
  for (const auto* view : views) {
    corners[0].push_back(view->left);
    corners[1].push_back(view->right);
  }
  Fit out;
  std::vector<cv::Mat> rotations, translations;
  for (int eye : {0, 1})
    cv::calibrateCamera(objects, corners[eye], size, out.K[eye], out.D[eye], rotations, translations);
  cv::Mat E, F, perView;
  cv::stereoCalibrate(objects, corners[0], corners[1], out.K[0], out.D[0], out.K[1], out.D[1], size, out.R,
                      out.t, E, F, perView, cv::CALIB_USE_INTRINSIC_GUESS,
                      {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 200, 1e-9});
  for (int i = 0; i < perView.rows; ++i)
    out.errors.push_back(std::hypot(perView.at<double>(i, 0), perView.at<double>(i, 1)) / std::sqrt(2.0));
  return out;
}

cameras::CameraRig makeEye(const cv::Mat& K, const cv::Mat& D, cv::Size size) {
  cameras::ImagePlaneParams plane;
  plane.fx = K.at<double>(0, 0), plane.fy = K.at<double>(1, 1);
  plane.cx = K.at<double>(0, 2), plane.cy = K.at<double>(1, 2);
  const double* d = D.ptr<double>();
  plane.k1 = d[0], plane.k2 = d[1], plane.p1 = d[2], plane.p2 = d[3], plane.k3 = d[4];
  return cameras::makeRig(std::make_shared<cameras::Pinhole>(size, plane));
}

cameras::StereoRig makeRig(const Fit& fit, cv::Size size) {
  cameras::StereoRig rig{makeEye(fit.K[0], fit.D[0], size), makeEye(fit.K[1], fit.D[1], size)};
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
  cv::cv2eigen(fit.R, R);
  cv::cv2eigen(fit.t, t);
  Eigen::Isometry3d T_right_left = Eigen::Isometry3d::Identity();
  T_right_left.linear() = R;
  T_right_left.translation() = t;
  rig.right.T_robot_cam = rig.left.T_robot_cam * T_right_left.inverse();
  return rig;
}

/// Holds the rig against the corners by our own camera model and rectification: a difference in conventions
/// would show.
void measure(const std::vector<const BoardPair*>& views, const CalibrationOptions& options,
             StereoCalibrationResult& result) {
  const cameras::Rectifier rectifier(result.rig);
  const auto& model = rectifier.model();
  const auto rectified = [&](const cameras::CameraRig& eye, const cv::Point2f& corner) {
    const Eigen::Vector3d ray =
        eye.camera->unproject({corner.x, corner.y}).value_or(Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d turned =
        rectifier.T_robot_cam().linear().transpose() * eye.T_robot_cam.linear() * ray;
    return Eigen::Vector2d(model.f * turned.x() / turned.z() + model.cx,
                           model.f * turned.y() / turned.z() + model.cy);
  };
  double rows = 0, sides = 0;
  int corners = 0, squares = 0;
  for (const auto* view : views) {
    Eigen::Vector3d last = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < view->left.size(); ++i) {
      const Eigen::Vector2d l = rectified(result.rig.left, view->left[i]),
                            r = rectified(result.rig.right, view->right[i]);
      rows += std::pow(l.y() - r.y(), 2);
      ++corners;
      const Eigen::Vector3d point = model.toPoint({l.x(), l.y(), l.x() - r.x()});
      if (static_cast<int>(i) % options.board.width != 0) {
        sides += std::pow((point - last).norm() - options.square, 2);
        ++squares;
      }
      last = point;
    }
  }
  result.rowError = std::sqrt(rows / std::max(1, corners));
  result.squareError = std::sqrt(sides / std::max(1, squares));
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Indices of the pairs of one moment: each pair alone tells where the right eye is, by the board in both
/// eyes. One of different moments would bend the whole fit.
std::vector<std::size_t> simultaneous(const std::vector<BoardPair>& views, cv::Size size,
                                      const CalibrationOptions& options) {
  const std::vector<std::vector<cv::Point3f>> objects(views.size(), boardPoints(options));
  std::vector<cv::Mat> rotations[2], translations[2];
  for (int eye : {0, 1}) {
    std::vector<std::vector<cv::Point2f>> corners;
    for (const auto& view : views) corners.push_back(eye == 0 ? view.left : view.right);
    cv::Mat K, D;
    cv::calibrateCamera(objects, corners, size, K, D, rotations[eye], translations[eye]);
  }
  std::vector<cv::Vec3d> offsets;  // of the right eye, for each pair
  for (std::size_t i = 0; i < views.size(); ++i) {
    cv::Mat left, right;
    cv::Rodrigues(rotations[0][i], left);
    cv::Rodrigues(rotations[1][i], right);
    offsets.emplace_back(cv::Mat(translations[1][i] - right * left.t() * translations[0][i]));
  }
  cv::Vec3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& offset : offsets) values.push_back(offset[axis]);
    middle[axis] = median(values);
  }
  std::vector<double> distances;
  for (const auto& offset : offsets) distances.push_back(cv::norm(offset - middle));
  const double limit = std::max(options.square, kApart * median(distances));
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (distances[i] <= limit) kept.push_back(i);
  return kept;
}

}  // namespace

std::optional<BoardPair> findBoards(const cv::Mat& left, const cv::Mat& right, cv::Size inner,
                                    const std::string& name) {
  auto l = findBoard(left, inner);
  if (!l) return std::nullopt;
  auto r = findBoard(right, inner);
  if (!r) return std::nullopt;
  if ((l->back() - l->front()).dot(r->back() - r->front()) < 0) std::reverse(r->begin(), r->end());
  return BoardPair{name, std::move(*l), std::move(*r)};
}

StereoCalibrationResult calibrateStereo(const std::vector<BoardPair>& views, cv::Size size,
                                        const CalibrationOptions& options) {
  if (views.size() < kFewestViews)
    throw base::Error("the board was found by both eyes in " + std::to_string(views.size()) +
                      " pairs of images; at least " + std::to_string(kFewestViews) +
                      " are needed, 15 and more are good");
  std::vector<std::size_t> wanted = simultaneous(views, size, options);
  if (wanted.size() < kFewestViews)
    throw base::Error(
        "only " + std::to_string(wanted.size()) + " of " + std::to_string(views.size()) +
        " pairs agree on where the right eye is; were both images of each pair taken at once, and "
        "is --board right?");
  StereoCalibrationResult result;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<const BoardPair*> used;
    for (const auto i : wanted) used.push_back(&views[i]);
    Fit solution;
    try {
      solution = fit(used, size, options);
      result.rig = makeRig(solution, size);
      measure(used, options, result);
    } catch (const cv::Exception& e) {
      throw base::Error("no calibration fits these images (" + e.err +
                        "); is --board right, and does the board take different places and tilts?");
    }
    result.views.clear();
    for (const auto& view : views) result.views.push_back({view.name, 0.0, false});
    double squares = 0;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      result.views[wanted[k]] = {views[wanted[k]].name, solution.errors[k], true};
      squares += solution.errors[k] * solution.errors[k];
    }
    result.rms = std::sqrt(squares / static_cast<double>(wanted.size()));
    const double limit = std::max(kNeverOutlier, kOutlierFactor * median(solution.errors));
    std::vector<std::size_t> kept;
    for (std::size_t k = 0; k < wanted.size(); ++k)
      if (solution.errors[k] <= limit) kept.push_back(wanted[k]);
    if (kept.size() == wanted.size() || kept.size() < kFewestViews) break;
    wanted = kept;
  }
  return result;
}

}  // namespace engram::apps
