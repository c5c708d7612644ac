// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "surf_extractor.h"

#include "base_extractor.h"
#include "surf_descriptor.h"
#include "surf_detector.h"

#include <array>

namespace engram::features {
namespace {

class SurfExtractor final : public BaseExtractor {
 public:
  SurfExtractor(const ExtractorParams& p, SimdLevel level)
      : BaseExtractor(p, types::DescriptorKind::kFloat, kSurfDim), level_(level) {}

 protected:
  Detection detect(const cv::Mat& grey, double thresholdFactor) const override {
    Detection d;
    d.integral = std::make_shared<const IntegralImage>(grey);
    d.keypoints =
        detectSurf(level_, *d.integral,
                   {params_.surf_threshold * thresholdFactor, params_.surf_octaves, params_.surf_step});
    return d;
  }

  types::Features describeAll(const cv::Mat&, const Detection& d,
                              std::span<const int> indices) const override {
    types::Features out{{}, types::Descriptors(kind(), dim()), {}};
    out.descriptors.reserve(indices.size());
    for (const int i : indices) {
      types::Keypoint k = d.keypoints[static_cast<std::size_t>(i)];
      if (!params_.upright) k.angle = surfAngle(level_, *d.integral, k);
      std::array<float, kSurfDim> descriptor;
      surfDescriptor(level_, *d.integral, k, descriptor.data());
      out.keypoints.push_back(k);
      out.descriptors.append(std::as_bytes(std::span(descriptor)));
    }
    return out;
  }

 private:
  const SimdLevel level_;
};

}  // namespace

std::unique_ptr<Extractor> makeSurfExtractor(const ExtractorParams& params, SimdLevel level) {
  return std::make_unique<SurfExtractor>(params, level);
}

}  // namespace engram::features
