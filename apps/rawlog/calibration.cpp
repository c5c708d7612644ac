// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "calibration.h"

#include "engram/base/error.h"
#include "engram/cameras/pinhole.h"
#include "engram/cameras/unified_sphere.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/ccalib/omnidir.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace engram::apps {
namespace {

constexpr std::size_t kFewestViews = 3;
constexpr double kOutlierFactor = 2.5;  // times the median rms of the views
constexpr double kNeverOutlier = 0.3;   // [px]
constexpr int kRounds = 4;

/// One solution over some of the views.
struct Fit {
  cameras::ImagePlaneParams plane;
  double xi = 0.0;
  std::vector<std::size_t> used;                 // which of the views; the solver may refuse some
  std::vector<cv::Mat> rotations, translations;  // board to camera, one for each of `used`
};

std::vector<cv::Point3d> boardPoints(const CalibrationOptions& options) {
  std::vector<cv::Point3d> points;
  for (int row = 0; row < options.board.height; ++row)
    for (int column = 0; column < options.board.width; ++column)
      points.emplace_back(column * options.square, row * options.square, 0.0);
  return points;
}

cameras::ImagePlaneParams planeOf(const cv::Matx33d& K, const std::vector<double>& d) {
  cameras::ImagePlaneParams plane;
  plane.fx = K(0, 0), plane.fy = K(1, 1), plane.cx = K(0, 2), plane.cy = K(1, 2);
  plane.k1 = d[0], plane.k2 = d[1], plane.p1 = d[2], plane.p2 = d[3];
  plane.k3 = d.size() > 4 ? d[4] : 0.0;
  return plane;
}

std::vector<cv::Mat> asList(const cv::Mat& rows) {
  std::vector<cv::Mat> list;
  for (int i = 0; i < static_cast<int>(rows.total()); ++i) {
    const cv::Vec3d v = rows.at<cv::Vec3d>(i);
    list.push_back((cv::Mat_<double>(3, 1) << v[0], v[1], v[2]));
  }
  return list;
}

using Corners = std::vector<std::vector<cv::Point2d>>;

Fit fitUnified(const std::vector<std::vector<cv::Point3d>>& objects, const Corners& corners, cv::Size size,
               const std::vector<std::size_t>& views) {
  cv::Mat K, xi, D, indices, rotations, translations;
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 300, 1e-9);
  cv::omnidir::calibrate(objects, corners, size, K, xi, D, rotations, translations,
                         cv::omnidir::CALIB_FIX_SKEW, criteria, indices);
  Fit fit;
  D = D.reshape(1, 1);
  fit.plane = planeOf(cv::Matx33d(K), std::vector<double>(D.begin<double>(), D.end<double>()));
  fit.xi = xi.at<double>(0);
  for (int i = 0; i < static_cast<int>(indices.total()); ++i)
    fit.used.push_back(views[static_cast<std::size_t>(indices.at<int>(i))]);
  fit.rotations = asList(rotations);
  fit.translations = asList(translations);
  return fit;
}

Fit fitPinhole(const std::vector<std::vector<cv::Point3d>>& objects, const Corners& corners, cv::Size size,
               const std::vector<std::size_t>& views) {
  std::vector<std::vector<cv::Point3f>> objects32;
  std::vector<std::vector<cv::Point2f>> corners32;
  for (const auto& points : objects) objects32.emplace_back(points.begin(), points.end());
  for (const auto& points : corners) corners32.emplace_back(points.begin(), points.end());
  cv::Mat K;
  std::vector<double> D;
  Fit fit;
  cv::calibrateCamera(objects32, corners32, size, K, D, fit.rotations, fit.translations);
  fit.plane = planeOf(cv::Matx33d(K), D);
  fit.used = views;
  return fit;
}

std::shared_ptr<const cameras::Camera> makeCamera(const Fit& fit, cv::Size size, bool unified) {
  if (unified) return std::make_shared<cameras::UnifiedSphere>(size, fit.xi, fit.plane);
  return std::make_shared<cameras::Pinhole>(size, fit.plane);
}

/// Through our own camera model, so a difference in conventions would show.
double rmsOf(const cameras::Camera& camera, const std::vector<cv::Point3d>& board, const BoardView& view,
             const cv::Mat& rotation, const cv::Mat& translation) {
  cv::Matx33d R;
  cv::Rodrigues(rotation, R);
  const cv::Vec3d t(translation.ptr<double>());
  double sum = 0.0;
  for (std::size_t i = 0; i < board.size(); ++i) {
    const cv::Vec3d p = R * cv::Vec3d(board[i]) + t;
    const auto pixel = camera.project({p[0], p[1], p[2]});
    if (!pixel) return 1e6;
    sum += std::pow(pixel->x() - view.corners[i].x, 2) + std::pow(pixel->y() - view.corners[i].y, 2);
  }
  return std::sqrt(sum / static_cast<double>(board.size()));
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The same camera for a world seen in a mirror: x and -x exchanged before distortion.
cameras::ImagePlaneParams mirrored(cameras::ImagePlaneParams plane) {
  plane.fx = -plane.fx;
  plane.p2 = -plane.p2;
  return plane;
}

}  // namespace

std::optional<std::vector<cv::Point2f>> findBoard(const cv::Mat& image, cv::Size inner) {
  cv::Mat grey = image;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  cv::Mat even;
  cv::createCLAHE(4.0, {8, 8})->apply(grey, even);
  std::vector<cv::Point2f> corners;
  // Each of these misses boards that another finds: dark, strongly bent, or half in the shade.
  constexpr int kAdaptive = cv::CALIB_CB_ADAPTIVE_THRESH;
  const bool found =
      cv::findChessboardCorners(even, inner, corners, kAdaptive) ||
      cv::findChessboardCorners(grey, inner, corners, kAdaptive | cv::CALIB_CB_NORMALIZE_IMAGE) ||
      cv::findChessboardCornersSB(grey, inner, corners, cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_ACCURACY);
  if (!found) return std::nullopt;
  double spacing = 1e9;  // the window must not reach the next corner
  for (std::size_t i = 1; i < corners.size(); ++i)
    if (static_cast<int>(i) % inner.width != 0)
      spacing = std::min(spacing, cv::norm(corners[i] - corners[i - 1]));
  const int half = std::clamp(static_cast<int>(spacing * 0.35), 2, 9);
  cv::cornerSubPix(grey, corners, {half, half}, {-1, -1},
                   {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-3});
  return corners;
}

CalibrationResult calibrate(const std::vector<BoardView>& views, cv::Size size,
                            const CalibrationOptions& options) {
  if (views.size() < kFewestViews)
    throw base::Error("the board was found in " + std::to_string(views.size()) + " images; at least " +
                      std::to_string(kFewestViews) + " are needed, 10 and more are good");
  const auto board = boardPoints(options);
  std::vector<std::size_t> wanted(views.size());
  std::iota(wanted.begin(), wanted.end(), std::size_t{0});
  CalibrationResult result;
  for (int round = 0; round < kRounds; ++round) {
    Corners corners;
    for (const auto i : wanted) corners.emplace_back(views[i].corners.begin(), views[i].corners.end());
    const std::vector<std::vector<cv::Point3d>> objects(wanted.size(), board);
    Fit fit;
    try {
      fit = options.unified ? fitUnified(objects, corners, size, wanted)
                            : fitPinhole(objects, corners, size, wanted);
    } catch (const cv::Exception& e) {
      throw base::Error("no calibration fits these images (" + e.err +
                        "); is --board right, and does the board " + "take different places and tilts?");
    }
    result.camera = makeCamera(fit, size, options.unified);
    result.views.clear();
    for (const auto& view : views) result.views.push_back({view.name, 0.0, false});
    std::vector<double> errors;
    for (std::size_t k = 0; k < fit.used.size(); ++k) {
      auto& view = result.views[fit.used[k]];
      view.used = true;
      view.rms = rmsOf(*result.camera, board, views[fit.used[k]], fit.rotations[k], fit.translations[k]);
      errors.push_back(view.rms);
    }
    if (errors.empty()) throw base::Error("no calibration fits these images; is --board right?");
    double sum = 0.0;
    for (const double e : errors) sum += e * e;
    result.rms = std::sqrt(sum / static_cast<double>(errors.size()));
    const double limit = std::max(kNeverOutlier, kOutlierFactor * median(errors));
    std::vector<std::size_t> kept;
    for (const auto i : fit.used)
      if (result.views[i].rms <= limit) kept.push_back(i);
    if (kept.size() == fit.used.size() || kept.size() < kFewestViews) break;
    wanted = kept;
  }
  if (!(result.rms < 1e5)) throw base::Error("no calibration fits these images; is --board right?");
  if (options.mirrored) {
    Fit fit;
    if (const auto* sphere = dynamic_cast<const cameras::UnifiedSphere*>(result.camera.get())) {
      fit.plane = mirrored(sphere->plane());
      fit.xi = sphere->xi();
    } else {
      fit.plane = mirrored(dynamic_cast<const cameras::Pinhole&>(*result.camera).plane());
    }
    result.camera = makeCamera(fit, size, options.unified);
  }
  return result;
}

}  // namespace engram::apps
