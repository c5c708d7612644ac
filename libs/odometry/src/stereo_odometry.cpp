// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/odometry/stereo_odometry.h"

#include "engram/base/error.h"
#include "engram/geometry/stereo_verify.h"
#include "keyframe.h"
#include "patch_matcher.h"
#include "wide_baseline.h"

#include <opencv2/video/tracking.hpp>

namespace engram::odometry {
namespace {

using Eigen::Isometry3d;

constexpr double kSure = 0.5;          // share of the tracks in agreement from which nothing else is tried
constexpr int kNear = 2;               // levels of the pyramid that do when the motion is as expected
constexpr float kStillSimilar = 0.5f;  // correlation of what is tracked: where it is less, tracking got stuck
constexpr double kCorrelated = 4;      // see estimate()
constexpr int kReach = 6;              // [px] from the expected disparity, and …
constexpr float kReachShare = 0.3f;    // … as a share of it
constexpr int kSuggestion = 10;        // inliers from which a motion may be right

double angleOf(const Isometry3d& T) { return Eigen::AngleAxisd(T.linear()).angle(); }

OdometryReason reasonOf(geometry::Reason reason) {
  switch (reason) {
    case geometry::Reason::kOk:
      return OdometryReason::kOk;
    case geometry::Reason::kTooFewMatches:
      return OdometryReason::kTooFewMatches;
    case geometry::Reason::kDegenerate:
      return OdometryReason::kDegenerate;
    case geometry::Reason::kLowRatio:
      return OdometryReason::kLowRatio;
    default:
      return OdometryReason::kTooFewInliers;
  }
}

}  // namespace

class StereoOdometry::Impl {
 public:
  Impl(const types::StereoModel& model, cv::Mat mask, const OdometryParams& params)
      : model_(model), mask_(std::move(mask)), params_(params), wide_(model, mask_) {
    base::validate(params);
  }

  OdometryResult process(const types::StereoPair& pair, const std::optional<Isometry3d>& T_last_now);
  void reset() { keyframe_.reset(); }

 private:
  std::vector<geometry::StereoMatch> track(const View& now, const Isometry3d& expected, int levels) const;
  void estimate(std::span<const geometry::StereoMatch> matches, OdometryResult& result) const;
  void find(View& now, const Isometry3d& expected, OdometryResult& result);
  bool keyframeDue(const OdometryResult& result) const;
  bool makeKeyframe(View& now);
  void recover(View& now, OdometryResult& result);

  types::StereoModel model_;
  cv::Mat mask_;
  OdometryParams params_;
  WideBaseline wide_;
  std::optional<View> keyframe_;
  Isometry3d T_keyframe_last_ = Isometry3d::Identity();
  Isometry3d lastMotion_ = Isometry3d::Identity();  // T_before_last, for the expectation
};

/// Points of the keyframe that are found in the left image near where they are expected, and from there in
/// the right one.
std::vector<geometry::StereoMatch> StereoOdometry::Impl::track(const View& now, const Isometry3d& expected,
                                                               int levels) const {
  const Isometry3d T_now_keyframe = expected.inverse();
  std::vector<const types::StereoPoint*> sought;
  std::vector<cv::Point2f> from, to;
  std::vector<float> disparities;  // expected
  for (const auto& p : keyframe_->points()) {
    const Eigen::Vector3d point = T_now_keyframe * model_.toPoint(p);
    if (point.z() < 0.1) continue;
    const types::StereoPoint at = model_.project(point);
    if (at.u < 0 || at.v < 0 || at.u >= now.pair().left.cols || at.v >= now.pair().left.rows) continue;
    sought.push_back(&p);
    from.emplace_back(static_cast<float>(p.u), static_cast<float>(p.v));
    to.emplace_back(static_cast<float>(at.u), static_cast<float>(at.v));
    disparities.push_back(static_cast<float>(at.disparity));
  }
  std::vector<geometry::StereoMatch> matches;
  if (sought.empty()) return matches;
  std::vector<std::uint8_t> found;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(keyframe_->pyramid(), now.pyramid(), from, to, found, error,
                           {params_.track_window, params_.track_window}, levels - 1,
                           {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 12, 0.03},
                           cv::OPTFLOW_USE_INITIAL_FLOW, 1e-3);
  for (std::size_t i = 0; i < sought.size(); ++i) {
    if (!found[i] || similarity(keyframe_->pair().left, from[i], now.pair().left, to[i]) < kStillSimilar)
      continue;
    const int reach = kReach + static_cast<int>(disparities[i] * kReachShare);
    if (const auto d = now.rows().disparity(to[i].x, to[i].y, disparities[i], reach))
      matches.push_back({*sought[i], {to[i].x, to[i].y, *d}});
  }
  return matches;
}

/// The covariance of the refinement takes the errors of the points to be independent. Those of neighbours,
/// and of the eyes, are not: on simulated drives the true errors have twice the deviations that it gives.
void StereoOdometry::Impl::estimate(std::span<const geometry::StereoMatch> matches,
                                    OdometryResult& result) const {
  const auto verified = geometry::verifyStereo(matches, model_,
                                               {.min_inliers = params_.min_inliers,
                                                .min_inlier_ratio = params_.min_inlier_ratio,
                                                .max_error = params_.max_error,
                                                .seed = params_.seed});
  result.reason = reasonOf(verified.reason);
  result.matches = static_cast<int>(matches.size());
  result.inliers = static_cast<int>(verified.inliers.size());
  result.T_keyframe_now = verified.T_a_b;
  result.T_keyframe_now.cov *= kCorrelated;
  result.sigma = verified.sigma;
}

/// Tracks near where the motion is expected, then further; where that fails, or few of the tracks agree,
/// descriptors are asked. A motion that they suggest tells where to look for more, so that one that is right
/// but has few inliers is not lost.
void StereoOdometry::Impl::find(View& now, const Isometry3d& expected, OdometryResult& result) {
  const int levels = params_.track_levels;
  estimate(track(now, expected, std::min(kNear, levels)), result);
  const auto sure = [&] { return result.ok() && result.inliers >= kSure * result.matches; };
  if (levels > kNear && (!sure() || result.inliers < kSure * result.points))
    estimate(track(now, expected, levels), result);
  if (sure() || !params_.wide_baseline) return;
  const auto attempt = [&](std::span<const geometry::StereoMatch> matches) {
    OdometryResult other;
    other.points = result.points;
    estimate(matches, other);
    if (other.ok() < result.ok() || (other.ok() == result.ok() && other.inliers <= result.inliers)) return;
    result = other;
    result.wideBaseline = true;
  };
  attempt(wide_.match(*keyframe_, now));
  if (result.inliers < kSuggestion) return;
  auto near = wide_.matchNear(*keyframe_, now, result.T_keyframe_now.T_a_b);
  const auto tracked = track(now, result.T_keyframe_now.T_a_b, levels);
  near.insert(near.end(), tracked.begin(), tracked.end());
  attempt(near);
}

bool StereoOdometry::Impl::keyframeDue(const OdometryResult& result) const {
  const Isometry3d& T = result.T_keyframe_now.T_a_b;
  return T.translation().norm() >= params_.keyframe_distance || angleOf(T) >= params_.keyframe_angle ||
         result.inliers < params_.keyframe_score * result.points;
}

bool StereoOdometry::Impl::makeKeyframe(View& now) {
  now.findPoints(mask_, params_);
  if (static_cast<int>(now.points().size()) < params_.min_inliers) return false;
  keyframe_ = std::move(now);
  T_keyframe_last_.setIdentity();
  return true;
}

/// Why the motion of a frame is unknown; the frame becomes the keyframe if it can.
void StereoOdometry::Impl::recover(View& now, OdometryResult& result) {
  result.T_keyframe_now = {.cov = types::Matrix6d::Zero()};
  lastMotion_.setIdentity();
  result.newKeyframe = makeKeyframe(now);
  if (result.newKeyframe) return;
  result.reason =
      now.corners() < params_.min_inliers ? OdometryReason::kTooFewCorners : OdometryReason::kTooFewPoints;
}

OdometryResult StereoOdometry::Impl::process(const types::StereoPair& pair,
                                             const std::optional<Isometry3d>& T_last_now) {
  if (pair.left.type() != CV_8UC1 || pair.right.type() != CV_8UC1 || pair.left.size() != pair.right.size())
    throw base::Error("stereo odometry needs two grey images of one size; are they rectified?");
  View now(pair, params_);
  OdometryResult result;
  if (!keyframe_) {
    recover(now, result);
    return result;
  }
  result.points = static_cast<int>(keyframe_->points().size());
  find(now, T_keyframe_last_ * T_last_now.value_or(lastMotion_), result);
  if (!result.ok()) {
    recover(now, result);
    return result;
  }
  lastMotion_ = T_keyframe_last_.inverse() * result.T_keyframe_now.T_a_b;
  T_keyframe_last_ = result.T_keyframe_now.T_a_b;
  result.newKeyframe = keyframeDue(result) && makeKeyframe(now);
  return result;
}

StereoOdometry::StereoOdometry(const types::StereoModel& model, cv::Mat mask, const OdometryParams& params)
    : impl_(std::make_unique<Impl>(model, std::move(mask), params)) {}
StereoOdometry::~StereoOdometry() = default;
StereoOdometry::StereoOdometry(StereoOdometry&&) noexcept = default;
StereoOdometry& StereoOdometry::operator=(StereoOdometry&&) noexcept = default;
OdometryResult StereoOdometry::process(const types::StereoPair& pair,
                                       const std::optional<Isometry3d>& T_last_now) {
  return impl_->process(pair, T_last_now);
}
void StereoOdometry::reset() { impl_->reset(); }

const char* toString(OdometryReason reason) {
  switch (reason) {
    case OdometryReason::kOk:
      return "ok";
    case OdometryReason::kFirst:
      return "first";
    case OdometryReason::kTooFewCorners:
      return "too_few_corners";
    case OdometryReason::kTooFewPoints:
      return "too_few_points";
    case OdometryReason::kTooFewMatches:
      return "too_few_matches";
    case OdometryReason::kTooFewInliers:
      return "too_few_inliers";
    case OdometryReason::kLowRatio:
      return "low_inlier_ratio";
    case OdometryReason::kDegenerate:
      return "degenerate";
  }
  return "?";
}

}  // namespace engram::odometry
