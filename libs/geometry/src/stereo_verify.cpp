// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/geometry/stereo_verify.h"

#include "engram/base/error.h"
#include "ransac.h"
#include "stereo_problem.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace engram::geometry {
namespace {

constexpr double kVoteFactor = 1.88;  // V-07, "experimental"
constexpr double kRigid = 3;          // deviations by which distances in a sample may differ
constexpr double kLine = 2;           // times the largest error: deviation from a line that counts as none
constexpr int kRounds = 5;

}  // namespace

StereoInliers::StereoInliers(std::span<const StereoMatch> matches, const types::StereoModel& m,
                             const StereoVerifyParams& params)
    : baseline_(static_cast<float>(m.baseline)),
      limit_(static_cast<float>(std::pow(params.max_error / m.f, 2))),
      byDepth_(params.vote == "depth") {
  for (const auto& [a, b] : matches) {
    if (!(a.disparity > 0) || !(b.disparity > 0))
      throw base::Error("stereo verification: a match without a positive disparity");
    a_.push_back(m.toPoint(a));
    b_.push_back(m.toPoint(b));
    const double za = a_.back().z(), zb = b_.back().z(), fb = m.f * m.baseline;
    depthNoise_.push_back(std::hypot(za * za, zb * zb) / fb);
    rayX_.push_back(static_cast<float>((a.u - m.cx) / m.f));
    rayY_.push_back(static_cast<float>((a.v - m.cy) / m.f));
    nearness_.push_back(static_cast<float>(1 / za));
    left_.push_back(static_cast<float>((b.u - m.cx) / m.f));
    row_.push_back(static_cast<float>((b.v - m.cy) / m.f));
    right_.push_back(static_cast<float>((b.u - b.disparity - m.cx) / m.f));
    // V eq (4) with the mean distance of the pair.
    const double z = 0.5 * (a_.back().norm() + b_.back().norm());
    voteLimit_.push_back(static_cast<float>(std::pow(kVoteFactor * z * z / fb * params.depth_precision, 2)));
  }
}

/// Squared distance, in units of the focal length, between where the motion puts a point in the images of b
/// and where it was seen. A mistake of one pixel in the disparity of a counts no more than one in b: with g
/// the derivative of the prediction by that disparity, e^2 = r^T (I + g g^T)^-1 r.
inline float StereoInliers::squaredError(const Eigen::Isometry3f& T, std::size_t i) const {
  const auto& m = T.matrix();
  const float x = rayX_[i], y = rayY_[i], n = nearness_[i];
  const float qx = m(0, 0) * x + m(0, 1) * y + m(0, 2) + m(0, 3) * n;
  const float qy = m(1, 0) * x + m(1, 1) * y + m(1, 2) + m(1, 3) * n;
  const float qz = m(2, 0) * x + m(2, 1) * y + m(2, 2) + m(2, 3) * n;
  const float inverse = 1.0f / qz;
  const float u = qx * inverse, v = qy * inverse, d = baseline_ * n * inverse;
  const float r0 = u - left_[i], r1 = v - row_[i], r2 = u - d - right_[i];
  const float scale = inverse / baseline_;  // a disparity changes the nearness by 1 / baseline
  const float g0 = (m(0, 3) - m(2, 3) * u) * scale, g1 = (m(1, 3) - m(2, 3) * v) * scale;
  const float g2 = g0 - (baseline_ - m(2, 3) * d) * scale;
  const float along = g0 * r0 + g1 * r1 + g2 * r2;
  const float e = r0 * r0 + r1 * r1 + r2 * r2 - along * along / (1 + g0 * g0 + g1 * g1 + g2 * g2);
  return qz > 1e-3f ? e : 1e9f;
}

int StereoInliers::count(const Eigen::Isometry3d& T_b_a) const {
  int count = 0;
  if (byDepth_) {
    for (std::size_t i = 0; i < a_.size(); ++i)
      count += (T_b_a * a_[i] - b_[i]).squaredNorm() <= voteLimit_[i];
    return count;
  }
  const Eigen::Isometry3f T = T_b_a.cast<float>();
  for (std::size_t i = 0; i < a_.size(); ++i) count += squaredError(T, i) <= limit_ ? 1 : 0;
  return count;
}

std::vector<int> StereoInliers::list(const Eigen::Isometry3d& T_b_a) const {
  const Eigen::Isometry3f T = T_b_a.cast<float>();
  std::vector<int> out;
  for (std::size_t i = 0; i < a_.size(); ++i) {
    const bool agrees =
        byDepth_ ? (T_b_a * a_[i] - b_[i]).squaredNorm() <= voteLimit_[i] : squaredError(T, i) <= limit_;
    if (agrees) out.push_back(static_cast<int>(i));
  }
  return out;
}

/// Distances between the points of a sample are the same in both views, as far as their depths are known.
template <int N>
bool RigidProblem<N>::rigid(const std::array<int, N>& sample) const {
  const auto &a = inliers_.pointsA(), &b = inliers_.pointsB();
  const auto& noise = inliers_.depthNoise();
  for (std::size_t i = 0; i < sample.size(); ++i)
    for (std::size_t j = i + 1; j < sample.size(); ++j) {
      const auto p = static_cast<std::size_t>(sample[i]), q = static_cast<std::size_t>(sample[j]);
      const double inA = (a[p] - a[q]).norm(), inB = (b[p] - b[q]).norm();
      if (std::abs(inA - inB) > kRigid * std::hypot(noise[p], noise[q])) return false;
    }
  return true;
}

template <int N>
int RigidProblem<N>::solve(const std::array<int, N>& sample, std::array<Model, 1>& models) const {
  if (!rigid(sample)) return 0;
  std::array<Eigen::Vector3d, N> a, b;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    a[i] = inliers_.pointsA()[static_cast<std::size_t>(sample[i])];
    b[i] = inliers_.pointsB()[static_cast<std::size_t>(sample[i])];
  }
  models[0] = alignPoints(b, a);
  return 1;
}

Eigen::Isometry3d alignPoints(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b) {
  Eigen::Vector3d centreA = Eigen::Vector3d::Zero(), centreB = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) {
    centreA += a[i] / static_cast<double>(a.size());
    centreB += b[i] / static_cast<double>(a.size());
  }
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - centreA) * (b[i] - centreB).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant();
  Eigen::Isometry3d T_a_b = Eigen::Isometry3d::Identity();
  T_a_b.linear() = svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
  T_a_b.translation() = centreA - T_a_b.linear() * centreB;
  return T_a_b;
}

namespace {

RansacResult<Eigen::Isometry3d> propose(const StereoInliers& inliers, const StereoVerifyParams& params) {
  const RansacParams ransacParams{params.confidence, params.max_iterations,
                                  static_cast<std::uint64_t>(params.seed)};
  if (params.sample_points == 5) return ransac(RigidProblem<5>(inliers), ransacParams);
  if (params.sample_points == 4) return ransac(RigidProblem<4>(inliers), ransacParams);
  return ransac(RigidProblem<3>(inliers), ransacParams);
}

std::vector<StereoMatch> select(std::span<const StereoMatch> matches, std::span<const int> indices) {
  std::vector<StereoMatch> out;
  out.reserve(indices.size());
  for (const int i : indices) out.push_back(matches[static_cast<std::size_t>(i)]);
  return out;
}

/// The closed form over all inliers of a hypothesis, V's final estimate. K and we refine it.
Eigen::Isometry3d alignInliers(const StereoInliers& inliers, std::span<const int> indices) {
  std::vector<Eigen::Vector3d> a, b;
  for (const int i : indices) {
    a.push_back(inliers.pointsA()[static_cast<std::size_t>(i)]);
    b.push_back(inliers.pointsB()[static_cast<std::size_t>(i)]);
  }
  return alignPoints(a, b);
}

/// Alternates between the best motion for the inliers and the inliers of that motion, while that wins some.
void polish(std::span<const StereoMatch> matches, const types::StereoModel& model,
            const StereoInliers& inliers, StereoEstimate& estimate, std::vector<int>& chosen) {
  for (int round = 0; round < kRounds; ++round) {
    const auto next = refineStereo(select(matches, chosen), model, estimate.T_a_b.T_a_b, round == 0 ? 10 : 5);
    auto agreeing = inliers.list(next.T_a_b.T_a_b.inverse());
    const bool settled = agreeing == chosen;
    if (round > 0 && !settled && agreeing.size() <= chosen.size()) break;
    estimate = next;
    chosen = std::move(agreeing);
    if (settled || chosen.size() < 3) break;
  }
}

/// Do the inliers lie on a line of the image, so that the rotation about it comes from their noise?
bool inOneLine(std::span<const StereoMatch> matches, std::span<const int> inliers, double width) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  for (const int i : inliers) {
    const auto& p = matches[static_cast<std::size_t>(i)].a;
    mean += Eigen::Vector2d(p.u, p.v) / static_cast<double>(inliers.size());
  }
  for (const int i : inliers) {
    const auto& p = matches[static_cast<std::size_t>(i)].a;
    const Eigen::Vector2d d = Eigen::Vector2d(p.u, p.v) - mean;
    squares += d * d.transpose() / static_cast<double>(inliers.size());
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(squares).eigenvalues()[0] < width * width;
}

}  // namespace

StereoVerification verifyStereo(std::span<const StereoMatch> matches, const types::StereoModel& model,
                                const StereoVerifyParams& params) {
  StereoVerification out;
  out.T_a_b.cov.setZero();
  const int n = static_cast<int>(matches.size());
  if (n < std::max(params.min_inliers, params.sample_points)) return out;
  const StereoInliers inliers(matches, model, params);
  const auto best = propose(inliers, params);
  out.iterations = best.iterations;
  out.reason = best.inliers == 0 ? Reason::kDegenerate : Reason::kTooFewInliers;
  if (best.inliers < 3) return out;
  out.inliers = inliers.list(best.model);
  StereoEstimate estimate{{.T_a_b = best.model.inverse()}, 0};
  if (params.vote == "depth") estimate.T_a_b.T_a_b = alignInliers(inliers, out.inliers);
  polish(matches, model, inliers, estimate, out.inliers);
  out.T_a_b = estimate.T_a_b;
  out.sigma = estimate.sigma;
  const int k = static_cast<int>(out.inliers.size());
  if (k < params.min_inliers)
    out.reason = Reason::kTooFewInliers;
  else if (k < params.min_inlier_ratio * n)
    out.reason = Reason::kLowRatio;
  else if (inOneLine(matches, out.inliers, kLine * params.max_error))
    out.reason = Reason::kDegenerate;
  else
    out.reason = Reason::kOk;
  return out;
}

StereoVerification verifyStereo(const types::Features& a, const types::Features& b,
                                std::span<const types::Match> matches, const types::StereoModel& model,
                                const StereoVerifyParams& params) {
  if (!matches.empty() && (a.ranges.size() != a.size() || b.ranges.size() != b.size()))
    throw base::Error("stereo verification needs the range of every feature; are these stereo views?");
  std::vector<StereoMatch> known;
  std::vector<int> index;  // of the match
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const auto ia = static_cast<std::size_t>(matches[i].a), ib = static_cast<std::size_t>(matches[i].b);
    if (!(a.ranges.at(ia) > 0) || !(b.ranges.at(ib) > 0)) continue;
    known.push_back({stereoPoint(a.keypoints[ia], a.ranges[ia], model),
                     stereoPoint(b.keypoints[ib], b.ranges[ib], model)});
    index.push_back(static_cast<int>(i));
  }
  StereoVerification out = verifyStereo(known, model, params);
  for (int& i : out.inliers) i = index[static_cast<std::size_t>(i)];
  return out;
}

void StereoVerifyParams::describe(base::Params& p) {
  p.add("min_inliers", min_inliers, "matches that must agree with one motion", base::Range{3, 1e6});
  p.add("min_inlier_ratio", min_inlier_ratio, "share of the matches that must agree", {0, 1});
  p.addChoice("vote", vote,
              "when a match agrees: by its reprojection in both eyes, or by the distance of its points "
              "against the uncertainty of depth (V eq 4)",
              {"reprojection", "depth"});
  p.add("max_error", max_error, "vote = reprojection: largest error [px]", {0.01, 100});
  p.add("depth_precision", depth_precision, "vote = depth: precision of the disparity [px]", {0.01, 100});
  p.add("sample_points", sample_points, "points of a random sample", {3, 5});
  p.add("confidence", confidence, "of RANSAC to have drawn a sample without outliers", {0.5, 0.999999});
  p.add("max_iterations", max_iterations, "samples of RANSAC", {1, 1e7});
  p.add("seed", seed, "of the random samples", {0, 2147483647});
}

}  // namespace engram::geometry
