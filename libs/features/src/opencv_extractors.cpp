// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// OpenCV's feature objects are not const, so each extraction makes its own: it costs microseconds.
#include "opencv_extractors.h"

#include "base_extractor.h"

#include <opencv2/features2d.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace engram::features {
namespace {

constexpr int kSiftDim = 128, kAkazeBits = 486, kOrbBits = 256;

// Diameter of the described region per cv::KeyPoint::size: SIFT's 4×4 histograms of 3 sigma each, with size =
// 2 sigma; AKAZE's pattern of ±10 half sizes; ORB gives the patch itself.
constexpr float kSiftRegion = 6.0f, kAkazeRegion = 10.0f, kOrbRegion = 1.0f;

types::Keypoint toKeypoint(const cv::KeyPoint& k, float region, bool upright) {
  const float angle = upright ? 0.0f : k.angle * std::numbers::pi_v<float> / 180.0f;
  return {k.pt.x, k.pt.y, k.size * region, angle, k.response, static_cast<std::int8_t>(0)};
}

std::vector<types::Keypoint> toKeypoints(const std::vector<cv::KeyPoint>& raw, float region, bool upright) {
  std::vector<types::Keypoint> out;
  out.reserve(raw.size());
  for (const auto& k : raw) out.push_back(toKeypoint(k, region, upright));
  return out;
}

std::vector<cv::KeyPoint> pick(const std::vector<cv::KeyPoint>& raw, std::span<const int> indices) {
  std::vector<cv::KeyPoint> out;
  out.reserve(indices.size());
  for (const int i : indices) out.push_back(raw[static_cast<std::size_t>(i)]);
  return out;
}

/// Without orientation several points of one place and scale become the same point.
void makeUpright(std::vector<cv::KeyPoint>& raw) {
  for (auto& k : raw) k.angle = 0.0f;
  const auto key = [](const cv::KeyPoint& k) {
    return std::tuple(k.pt.y, k.pt.x, k.size, k.octave, -k.response);
  };
  std::sort(raw.begin(), raw.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  const auto same = [](const auto& a, const auto& b) { return a.pt == b.pt && a.size == b.size; };
  raw.erase(std::unique(raw.begin(), raw.end(), same), raw.end());
}

void appendBinary(types::Descriptors& out, const std::uint8_t* bits) {
  std::vector<std::byte> row(out.rowBytes(), std::byte{0});
  std::memcpy(row.data(), bits, static_cast<std::size_t>(out.dim() + 7) / 8);
  out.append(row);
}

/// Unit L2 norm; with `root` the square root of the L1-normalised components instead.
void appendUnit(types::Descriptors& out, const float* values, bool root) {
  const auto n = static_cast<std::size_t>(out.dim());
  std::vector<float> row(values, values + n);
  double norm = 0;
  for (const float v : row) norm += root ? std::abs(v) : double(v) * v;
  norm = root ? norm : std::sqrt(norm);
  if (norm > 0)
    for (float& v : row) v = static_cast<float>(root ? std::sqrt(std::max(0.0, v / norm)) : v / norm);
  out.append(std::as_bytes(std::span(row)));
}

class SiftExtractor final : public BaseExtractor {
 public:
  explicit SiftExtractor(const ExtractorParams& p)
      : BaseExtractor(p, types::DescriptorKind::kFloat, kSiftDim) {}

 protected:
  Detection detect(const cv::Mat& grey, double thresholdFactor) const override {
    Detection d;
    const auto sift = cv::SIFT::create(0, 3, params_.sift_contrast * thresholdFactor);
    // Describes all at once where it can: the scale space would be built twice.
    if (!params_.upright) {
      sift->detectAndCompute(grey, cv::noArray(), d.raw, d.descriptors);
    } else {
      sift->detect(grey, d.raw);
      makeUpright(d.raw);
    }
    d.keypoints = toKeypoints(d.raw, kSiftRegion, params_.upright);
    return d;
  }

  types::Features describeAll(const cv::Mat& grey, const Detection& d,
                              std::span<const int> indices) const override {
    auto raw = pick(d.raw, indices);
    types::Features out{
        toKeypoints(raw, kSiftRegion, params_.upright), types::Descriptors(kind(), dim()), {}};
    if (!d.descriptors.empty()) {
      for (const int i : indices) appendUnit(out.descriptors, d.descriptors.ptr<float>(i), params_.sift_root);
      return out;
    }
    cv::Mat descriptors;
    cv::SIFT::create()->compute(grey, raw, descriptors);
    for (int i = 0; i < descriptors.rows; ++i)
      appendUnit(out.descriptors, descriptors.ptr<float>(i), params_.sift_root);
    return out;
  }
};

class AkazeExtractor final : public BaseExtractor {
 public:
  explicit AkazeExtractor(const ExtractorParams& p)
      : BaseExtractor(p, types::DescriptorKind::kBinary, kAkazeBits) {}

 protected:
  // Describes all at once: the non-linear scale space is the larger part of the work and would be built
  // twice.
  Detection detect(const cv::Mat& grey, double thresholdFactor) const override {
    Detection d;
    const auto type = params_.upright ? cv::AKAZE::DESCRIPTOR_MLDB_UPRIGHT : cv::AKAZE::DESCRIPTOR_MLDB;
    const auto threshold = static_cast<float>(params_.akaze_threshold * thresholdFactor);
    cv::AKAZE::create(type, 0, 3, threshold)->detectAndCompute(grey, cv::noArray(), d.raw, d.descriptors);
    d.keypoints = toKeypoints(d.raw, kAkazeRegion, params_.upright);
    return d;
  }

  types::Features describeAll(const cv::Mat&, const Detection& d,
                              std::span<const int> indices) const override {
    types::Features out{{}, types::Descriptors(kind(), dim()), {}};
    for (const int i : indices) {
      out.keypoints.push_back(d.keypoints[static_cast<std::size_t>(i)]);
      appendBinary(out.descriptors, d.descriptors.ptr<std::uint8_t>(i));
    }
    return out;
  }
};

class OrbExtractor final : public BaseExtractor {
 public:
  explicit OrbExtractor(const ExtractorParams& p)
      : BaseExtractor(p, types::DescriptorKind::kBinary, kOrbBits) {}

 protected:
  Detection detect(const cv::Mat& grey, double thresholdFactor) const override {
    Detection d;
    create(thresholdFactor)->detect(grey, d.raw);
    if (params_.upright)
      for (auto& k : d.raw) k.angle = 0.0f;
    d.keypoints = toKeypoints(d.raw, kOrbRegion, params_.upright);
    return d;
  }

  types::Features describeAll(const cv::Mat& grey, const Detection& d,
                              std::span<const int> indices) const override {
    auto raw = pick(d.raw, indices);
    cv::Mat descriptors;
    create(1.0)->compute(grey, raw, descriptors);
    types::Features out{toKeypoints(raw, kOrbRegion, params_.upright), types::Descriptors(kind(), dim()), {}};
    for (int i = 0; i < descriptors.rows; ++i)
      appendBinary(out.descriptors, descriptors.ptr<std::uint8_t>(i));
    return out;
  }

 private:
  // ORB keeps a fixed number a level. With a grid or a mask some of them go, so more are asked for.
  cv::Ptr<cv::ORB> create(double thresholdFactor) const {
    const int threshold = std::max(1, static_cast<int>(params_.orb_threshold * thresholdFactor));
    return cv::ORB::create(2 * params_.max_features, 1.2f, params_.orb_levels, 31, 0, 2,
                           cv::ORB::HARRIS_SCORE, 31, threshold);
  }
};

}  // namespace

std::unique_ptr<Extractor> makeSiftExtractor(const ExtractorParams& p) {
  return std::make_unique<SiftExtractor>(p);
}
std::unique_ptr<Extractor> makeAkazeExtractor(const ExtractorParams& p) {
  return std::make_unique<AkazeExtractor>(p);
}
std::unique_ptr<Extractor> makeOrbExtractor(const ExtractorParams& p) {
  return std::make_unique<OrbExtractor>(p);
}

}  // namespace engram::features
