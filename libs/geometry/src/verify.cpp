// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/geometry/verify.h"

#include "a_contrario.h"
#include "engram/base/error.h"
#include "problems.h"
#include "ransac.h"
#include "refine.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <optional>

namespace engram::geometry {
namespace {

constexpr double kNoiseFloor = 1e-4;  // [rad]; bearings are never better than this
constexpr std::size_t kShuffledPairs = 2000;
constexpr double kClearlyMore = 1.25;  // inliers; three more degrees of freedom win some by accident
constexpr double kWide = 5;  // factor on the inlier bounds for motion that is planar but for some tilt

enum class Search { kPlanar, kNearlyPlanar, kFree };

struct Candidate {
  bool found = false;
  TwoViewEstimate estimate;
  std::vector<int> inliers;  // indices into the pairs
  int iterations = 0;
};

/// The steps of verify() over the pairs of rays of the matches.
class Verifier {
 public:
  Verifier(std::vector<BearingPair> pairs, const Eigen::Vector3d& up, const VerifyParams& params)
      : pairs_(std::move(pairs)),
        up_(up),
        params_(params),
        test_{std::sin(params.max_angle), params.residual == "conic", params.conic_xi,
              params.max_conic_distance, params.R_optics_ray} {}

  Verification search() const;

 private:
  RansacParams ransacParams() const {
    return {params_.confidence, params_.max_iterations, static_cast<std::uint64_t>(params_.seed)};
  }
  std::optional<Eigen::Vector3d> upOf(bool planar) const {
    return planar ? std::optional(up_) : std::nullopt;
  }
  std::vector<BearingPair> select(std::span<const int> indices) const;
  bool informative(const BearingPair& pair, bool planar) const;
  std::vector<int> inliersOf(const TwoViewPose& pose) const;
  Verification run(Search search) const;
  Candidate propose(Search search) const;
  Candidate searchPlanar() const;
  Candidate searchNearlyPlanar() const;
  Candidate searchEssential() const;
  void polish(Candidate& candidate, bool planar) const;
  void dropInsignificantTranslation(Candidate& candidate, bool planar) const;
  double accidentalAgreement(const TwoViewPose& pose, bool planar) const;
  double log10Nfa(const TwoViewPose& pose, std::span<const int> inliers, bool planar) const;

  std::vector<BearingPair> pairs_;
  Eigen::Vector3d up_;
  const VerifyParams& params_;
  InlierTest test_;
};

std::vector<BearingPair> Verifier::select(std::span<const int> indices) const {
  std::vector<BearingPair> out;
  out.reserve(indices.size());
  for (const int i : indices) out.push_back(pairs_[static_cast<std::size_t>(i)]);
  return out;
}

/// A pair on the horizon agrees with every planar motion, so it can neither propose nor support one.
bool Verifier::informative(const BearingPair& pair, bool planar) const {
  return !planar || std::max(std::abs(pair.a.dot(up_)), std::abs(pair.b.dot(up_))) > test_.sine;
}

std::vector<int> Verifier::inliersOf(const TwoViewPose& pose) const {
  const Eigen::Matrix3d E = essentialOf(pose);
  std::vector<int> out;
  for (std::size_t i = 0; i < pairs_.size(); ++i)
    if (test_(E, pairs_[i]) && inFront(pose, pairs_[i], test_.sine)) out.push_back(static_cast<int>(i));
  return out;
}

Candidate Verifier::searchPlanar() const {
  std::vector<BearingPair> pool;
  for (const auto& pair : pairs_)
    if (informative(pair, true)) pool.push_back(pair);
  Eigen::Matrix3d R_cam_level;
  R_cam_level.col(2) = up_;
  R_cam_level.col(0) = up_.unitOrthogonal();
  R_cam_level.col(1) = up_.cross(R_cam_level.col(0));
  const PlanarProblem problem(pool, R_cam_level, test_);
  const auto best = ransac(problem, ransacParams());
  Candidate out;
  out.iterations = best.iterations;
  out.found = best.inliers > 0;
  if (!out.found) return out;
  TwoViewPose pose = problem.poseInCamera(best.model);
  out.inliers = inliersOf(pose);
  TwoViewPose opposite = pose;
  opposite.t_a_b = -pose.t_a_b;
  if (auto others = inliersOf(opposite); others.size() > out.inliers.size()) {
    out.inliers = std::move(others);
    pose = opposite;
  }
  out.estimate.pose = pose;
  return out;
}

/// A camera in a hand, or a robot on a ramp: planar motion within a wider angle leads to the free motion,
/// with two pairs a sample instead of eight.
Candidate Verifier::searchNearlyPlanar() const {
  Verifier wide = *this;
  wide.test_.sine *= kWide;
  wide.test_.maxConicDistance *= kWide;
  Candidate out = wide.searchPlanar();
  for (const double width : {kWide, 0.6 * kWide, 0.3 * kWide, 1.0}) {
    if (out.inliers.size() < 6) break;
    out.estimate = refine(select(out.inliers), out.estimate.pose, std::nullopt);
    wide.test_.sine = width * test_.sine;
    wide.test_.maxConicDistance = width * test_.maxConicDistance;
    out.inliers = wide.inliersOf(out.estimate.pose);
  }
  return out;
}

Candidate Verifier::searchEssential() const {
  const EssentialProblem problem(pairs_, test_);
  const auto best = ransac(problem, ransacParams());
  // Without parallax eight pairs determine no essential matrix, or one made of noise.
  const auto turned = ransac(RotationProblem(pairs_, test_.sine), ransacParams());
  Candidate out;
  out.iterations = best.iterations + turned.iterations;
  out.found = best.inliers > 0 || turned.inliers > 0;
  if (turned.inliers > 0.9 * best.inliers) {
    out.estimate.pose.R_a_b = turned.model;
    out.inliers = inliersOf(out.estimate.pose);
    return out;
  }
  for (const auto& pose : decompose(best.model)) {
    auto inliers = inliersOf(pose);
    if (inliers.size() < out.inliers.size()) continue;
    out.inliers = std::move(inliers);
    out.estimate.pose = pose;
  }
  return out;
}

/// Alternates between the best pose for the inliers and the inliers of that pose, while that wins inliers.
/// The first round always counts: a pose from a minimal sample has neither covariance nor noise.
void Verifier::polish(Candidate& candidate, bool planar) const {
  const std::size_t minimum = planar ? 2 : 5;
  for (int round = 0; round < 5 && candidate.inliers.size() > minimum; ++round) {
    const auto estimate = refine(select(candidate.inliers), candidate.estimate.pose, upOf(planar), 4);
    auto inliers = inliersOf(estimate.pose);
    const bool settled = inliers == candidate.inliers;
    if (round > 0 && !settled && inliers.size() <= candidate.inliers.size()) break;
    candidate.estimate = estimate;
    candidate.inliers = std::move(inliers);
    if (settled) break;
  }
}

/// Without parallax the direction of the translation is noise. The test: does a rotation alone explain the
/// inliers as well as their noise allows? Per pair the squared distance in units of its variance is
/// chi-square with two degrees of freedom, mean 2; values are cut at 9 so that a few wrong pairs do not pass
/// for parallax.
void Verifier::dropInsignificantTranslation(Candidate& candidate, bool planar) const {
  const auto pairs = select(candidate.inliers);
  const auto rotation = fitRotation(pairs, candidate.estimate.pose.R_a_b, upOf(planar), params_.max_angle);
  const double sigma = std::max(candidate.estimate.sigma, kNoiseFloor);
  const double limit = 2 * sin(params_.max_angle / 2);
  double sum = 0;
  std::vector<int> explained;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double distance = (pairs[i].a - rotation.pose.R_a_b * pairs[i].b).norm();
    sum += std::min(9.0, distance * distance / (2 * sigma * sigma));
    if (distance <= limit) explained.push_back(candidate.inliers[i]);
  }
  if (sum > 3.5 * static_cast<double>(pairs.size())) return;
  candidate.estimate = rotation;
  candidate.inliers = std::move(explained);
}

/// Share of the rays of a, paired with rays of b that they do not belong to, that agrees with the pose.
/// Measured, because it depends on where in the view the features are.
double Verifier::accidentalAgreement(const TwoViewPose& pose, bool planar) const {
  const Eigen::Matrix3d E = essentialOf(pose);
  const std::size_t n = pairs_.size();
  const std::size_t shifts = std::min(n - 1, kShuffledPairs / n + 1);
  int tried = 0, agreed = 0;
  for (std::size_t s = 0; s < shifts; ++s) {
    const std::size_t shift = 1 + s * (n - 1) / shifts;
    for (std::size_t i = 0; i < n; ++i) {
      const BearingPair pair{pairs_[i].a, pairs_[(i + shift) % n].b};
      if (!informative(pair, planar)) continue;
      ++tried;
      agreed += test_(E, pair) && inFront(pose, pair, test_.sine);
    }
  }
  return (agreed + std::sqrt(agreed) + 1) / (tried + 1.0);  // one standard deviation on the safe side
}

double Verifier::log10Nfa(const TwoViewPose& pose, std::span<const int> inliers, bool planar) const {
  int n = 0, k = 0;
  for (const auto& pair : pairs_) n += informative(pair, planar);
  for (const int i : inliers) k += informative(pairs_[static_cast<std::size_t>(i)], planar);
  // Two pairs and four poses, or five pairs and the ten solutions of the five-point problem, times two signs.
  return log10FalseAlarms(n, k, accidentalAgreement(pose, planar), planar ? 2 : 5, planar ? 4 : 20);
}

/// Planar motion may pass with a part of the inliers when the camera tilts: the free motion replaces it when
/// it explains clearly more.
Verification Verifier::search() const {
  Verification out = run(params_.model == "essential" ? Search::kFree : Search::kPlanar);
  if (params_.model != "planar_then_essential") return out;
  const auto explainsMore = [&out](const Verification& other) {
    return static_cast<double>(other.inliers.size()) > kClearlyMore * static_cast<double>(out.inliers.size());
  };
  Verification tilted = run(Search::kNearlyPlanar);
  if (tilted.ok() ? !out.ok() || explainsMore(tilted) : !out.ok() && explainsMore(tilted))
    out = std::move(tilted);
  if (out.ok()) return out;
  Verification free = run(Search::kFree);
  return free.ok() || explainsMore(free) ? free : out;
}

Candidate Verifier::propose(Search search) const {
  switch (search) {
    case Search::kPlanar:
      return searchPlanar();
    case Search::kNearlyPlanar:
      return searchNearlyPlanar();
    case Search::kFree:
      break;
  }
  return searchEssential();
}

Verification Verifier::run(Search search) const {
  Verification out;
  const bool planar = search == Search::kPlanar;
  const int n = static_cast<int>(pairs_.size());
  if (n < std::max(params_.min_inliers, planar ? 3 : 8)) return out;
  Candidate candidate = propose(search);
  out.iterations = candidate.iterations;
  out.reason = Reason::kDegenerate;
  if (!candidate.found) return out;
  out.reason = Reason::kTooFewInliers;
  if (candidate.inliers.size() < (planar ? 3 : 6)) return out;  // none to spare after fixing the motion
  polish(candidate, planar);
  out.log10Nfa = log10Nfa(candidate.estimate.pose, candidate.inliers, planar);
  const Eigen::Matrix3d E = essentialOf(candidate.estimate.pose);
  dropInsignificantTranslation(candidate, planar);

  out.T_a_b.T_a_b.linear() = candidate.estimate.pose.R_a_b;
  out.T_a_b.T_a_b.translation() = candidate.estimate.pose.t_a_b;
  out.T_a_b.cov = candidate.estimate.cov;
  const int k = static_cast<int>(candidate.inliers.size());
  for (const int i : candidate.inliers)
    out.meanError += angularError(E, pairs_[static_cast<std::size_t>(i)]) / k;
  out.inliers = std::move(candidate.inliers);
  if (k < params_.min_inliers)
    out.reason = Reason::kTooFewInliers;
  else if (k < params_.min_inlier_ratio * n)
    out.reason = Reason::kLowRatio;
  else if (!(out.log10Nfa <= params_.max_log10_nfa))
    out.reason = Reason::kAccidental;
  else
    out.reason = Reason::kOk;
  return out;
}

}  // namespace

void VerifyParams::describe(base::Params& p) {
  p.addChoice("model", model, "motion between two views", {"planar", "essential", "planar_then_essential"});
  p.add("min_inliers", min_inliers, "matches that must agree with one motion", base::Range{3, 1e6});
  p.add("min_inlier_ratio", min_inlier_ratio, "share of the matches that must agree", {0, 1});
  p.addDegrees("max_angle", max_angle,
               "largest angle between a ray and the epipolar plane of its partner [deg]", {0.001, 20});
  p.add("max_log10_nfa", max_log10_nfa,
        "log10 of the expected number of models that unrelated matches support as well; lower is stricter",
        {-300, 6});
  p.add("confidence", confidence, "of RANSAC to have drawn a sample without outliers", {0.5, 0.999999});
  p.add("max_iterations", max_iterations, "samples of RANSAC", {1, 1e7});
  p.add("seed", seed, "of the random samples", {0, 2147483647});
  p.addChoice("residual", residual, "inlier test: angle on the sphere, or the conic of F eq (1)",
              {"angular", "conic"});
  p.add("conic_xi", conic_xi, "residual = conic: mirror parameter xi; 0: that of the calibration", {0, 100});
  p.add("max_conic_distance", max_conic_distance,
        "residual = conic: largest distance from the conic, in pixels divided by the focal length",
        {1e-6, 1});
}

const char* toString(Reason reason) {
  switch (reason) {
    case Reason::kOk:
      return "ok";
    case Reason::kTooFewMatches:
      return "too_few_matches";
    case Reason::kDegenerate:
      return "degenerate";
    case Reason::kTooFewInliers:
      return "too_few_inliers";
    case Reason::kLowRatio:
      return "low_inlier_ratio";
    case Reason::kAccidental:
      return "accidental";
  }
  return "?";
}

Verification verify(const types::Features& a, const types::Features& b, std::span<const types::Match> matches,
                    const Eigen::Vector3d& up_cam, const VerifyParams& params) {
  if (!matches.empty() && (a.bearings.size() != a.size() || b.bearings.size() != b.size()))
    throw base::Error("verification needs the bearing of every feature; give a camera calibration");
  if (!(up_cam.norm() > 1e-9)) throw base::Error("verification: the up axis is the zero vector");
  std::vector<BearingPair> pairs;
  std::vector<int> index;  // of the match
  pairs.reserve(matches.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const Eigen::Vector3d rayA = a.bearings.at(static_cast<std::size_t>(matches[i].a)).cast<double>();
    const Eigen::Vector3d rayB = b.bearings.at(static_cast<std::size_t>(matches[i].b)).cast<double>();
    if (!(rayA.squaredNorm() > 0.5) || !(rayB.squaredNorm() > 0.5)) continue;
    pairs.push_back({rayA.normalized(), rayB.normalized()});
    index.push_back(static_cast<int>(i));
  }
  const Verifier verifier(std::move(pairs), up_cam.normalized(), params);
  Verification out = verifier.search();
  for (int& i : out.inliers) i = index[static_cast<std::size_t>(i)];
  return out;
}

}  // namespace engram::geometry
