// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "surf_detector.h"

#include "hessian.h"

#include <Eigen/Dense>

#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>

namespace engram::features {
namespace {

constexpr int kLayers = 4;
constexpr double kScalePerSize = 1.2 / 9;  // the 9×9 filter stands for sigma = 1.2 (Bay 2008, section 3.2)
// A fit that leaves its sample by more than this is no peak. The usual limit of 0.5 loses peaks that lie
// between two layers: each fit points to the other.
constexpr double kLargestOffset = 1.0;

/// Filter sizes 9, 15, 21, 27; 15, 27, 39, 51; 27, 51, 75, 99; … (Bay 2008, section 3.3).
BoxFilter filterOf(int octave, int layer) { return {(2 << octave) * (layer + 1) + 1}; }

/// Offset of the extremum of the quadratic through 3×3×3 values, in samples (x, y, layer) (Brown & Lowe
/// 2002).
std::optional<Eigen::Vector3d> fitPeak(const Neighbourhood& n, int x) {
  const auto v = [&](int l, int r, int c) { return static_cast<double>(n.rows[l + 1][r + 1][x + c]); };
  const double centre = 2 * v(0, 0, 0);
  const Eigen::Vector3d gradient =
      Eigen::Vector3d(v(0, 0, 1) - v(0, 0, -1), v(0, 1, 0) - v(0, -1, 0), v(1, 0, 0) - v(-1, 0, 0)) / 2;
  Eigen::Matrix3d hessian;
  hessian(0, 0) = v(0, 0, 1) + v(0, 0, -1) - centre;
  hessian(1, 1) = v(0, 1, 0) + v(0, -1, 0) - centre;
  hessian(2, 2) = v(1, 0, 0) + v(-1, 0, 0) - centre;
  hessian(0, 1) = hessian(1, 0) = (v(0, 1, 1) - v(0, 1, -1) - v(0, -1, 1) + v(0, -1, -1)) / 4;
  hessian(0, 2) = hessian(2, 0) = (v(1, 0, 1) - v(1, 0, -1) - v(-1, 0, 1) + v(-1, 0, -1)) / 4;
  hessian(1, 2) = hessian(2, 1) = (v(1, 1, 0) - v(1, -1, 0) - v(-1, 1, 0) + v(-1, -1, 0)) / 4;
  Eigen::Matrix3d inverse;
  bool invertible = false;
  hessian.computeInverseWithCheck(inverse, invertible, 1e-30);
  if (!invertible) return std::nullopt;
  const Eigen::Vector3d offset = -inverse * gradient;
  if (!(offset.cwiseAbs().maxCoeff() <= kLargestOffset)) return std::nullopt;
  return offset;
}

/// Walks down one octave with three rows of each layer in memory.
class OctaveScan {
 public:
  OctaveScan(SimdLevel level, const IntegralImage& image, int octave, int step, float threshold)
      : level_(level),
        image_(image),
        octave_(octave),
        step_(step),
        threshold_(threshold),
        hessian_(level, image),
        samples_((image.cols() - 1) / step + 1) {
    for (auto& layer : ring_)
      for (auto& row : layer) row.resize(static_cast<std::size_t>(samples_));
  }

  void run(std::vector<types::Keypoint>& out) {
    const int rows = (image_.rows() - 1) / step_ + 1;
    for (int r = 0; r < rows; ++r) {
      for (int l = 0; l < kLayers; ++l) {
        const BoxFilter f = filterOf(octave_, l);
        if (r * step_ < f.half() || r * step_ >= image_.rows() - f.half()) continue;
        hessian_.compute(f, r * step_, step_, rowOf(l, r));
      }
      for (int l = 1; r >= 2 && l < kLayers - 1; ++l) findInRow(l, r - 1, out);
    }
  }

 private:
  float* rowOf(int layer, int r) {
    return ring_[static_cast<std::size_t>(layer)][static_cast<std::size_t>(r % 3)].data();
  }

  /// Only where the filter of the layer above fits at the sample and its neighbours.
  void findInRow(int layer, int r, std::vector<types::Keypoint>& out) {
    const int margin = filterOf(octave_, layer + 1).half();
    if ((r - 1) * step_ < margin || (r + 1) * step_ >= image_.rows() - margin) return;
    const int begin = (margin + step_ - 1) / step_ + 1;
    const int end = (image_.cols() - margin - 1) / step_;  // the sample `end` still fits
    Neighbourhood n{};
    for (int l = 0; l < 3; ++l)
      for (int i = 0; i < 3; ++i) n.rows[l][i] = rowOf(layer - 1 + l, r - 1 + i);
    columns_.clear();
    findMaxima(level_, n, begin, end, threshold_, columns_);
    for (const int x : columns_)
      if (const auto offset = fitPeak(n, x)) out.push_back(keypoint(n, layer, r, x, *offset));
  }

  types::Keypoint keypoint(const Neighbourhood& n, int layer, int r, int x,
                           const Eigen::Vector3d& offset) const {
    const BoxFilter f = filterOf(octave_, layer);
    const double growth = filterOf(octave_, layer + 1).size() - f.size();
    types::Keypoint k;
    k.x = static_cast<float>((x + offset.x()) * step_);
    k.y = static_cast<float>((r + offset.y()) * step_);
    k.size = static_cast<float>(kSurfWindow * kScalePerSize * (f.size() + offset.z() * growth));
    k.response = n.rows[1][1][x];
    k.sign = static_cast<std::int8_t>(laplacianSign(image_, f, r * step_, x * step_));
    return k;
  }

  const SimdLevel level_;
  const IntegralImage& image_;
  const int octave_, step_;
  const float threshold_;
  HessianRows hessian_;
  const int samples_;
  std::array<std::array<std::vector<float>, 3>, kLayers> ring_;
  std::vector<int> columns_;
};

}  // namespace

std::vector<types::Keypoint> detectSurf(SimdLevel level, const IntegralImage& image,
                                        const SurfDetectorParams& params) {
  std::vector<types::Keypoint> out;
  for (int octave = 0; octave < params.octaves; ++octave)
    OctaveScan(level, image, octave, params.step << octave, static_cast<float>(params.threshold)).run(out);
  return out;
}

}  // namespace engram::features
