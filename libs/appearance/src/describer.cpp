// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/appearance/describer.h"

#include "engram/base/error.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace engram::appearance {
namespace {

constexpr int kCell = 8;      // [px] of a patch, or of a cell of gradients
constexpr int kHeadings = 4;  // directions tried within the width of a cell

/// The strip after the camera has turned by so many columns.
cv::Mat turned(const cv::Mat& strip, int columns) {
  if (columns == 0) return strip;
  cv::Mat out;
  cv::hconcat(strip.colRange(columns, strip.cols), strip.colRange(0, columns), out);
  return out;
}

/// Patches of equal light: what is dark by day may be lit at night.
class Thumbnail final : public Describer {
 public:
  explicit Thumbnail(std::optional<Panorama> panorama) : Describer(std::move(panorama)) {}
  Eigen::Index dim() const override { return kSize.area(); }
  std::uint32_t name() const override { return 1; }

 private:
  static constexpr float kNoise = 3;  // deviation below which a patch is taken to be plain [grey values]
  static inline const cv::Size kSize{64, 32};
  cv::Size gridSize() const override { return kSize; }

  /// Column after column of patches, so that a turn of the camera is a shift of the vector.
  Eigen::VectorXf ofGrid(const cv::Mat& grey) const override {
    Eigen::VectorXf v(dim());
    Eigen::Index at = 0;
    for (int x = 0; x < kSize.width; x += kCell)
      for (int y = 0; y < kSize.height; y += kCell) {
        cv::Scalar mean, deviation;
        const cv::Mat patch = grey(cv::Rect(x, y, kCell, kCell));
        cv::meanStdDev(patch, mean, deviation);
        for (int i = 0; i < kCell; ++i)
          for (int j = 0; j < kCell; ++j)
            v[at++] = (patch.at<float>(j, i) - static_cast<float>(mean[0])) /
                      (static_cast<float>(deviation[0]) + kNoise);
      }
    return v;
  }
};

/// N. Dalal and B. Triggs, Histograms of Oriented Gradients for Human Detection, CVPR 2005: cells of unsigned
/// directions, each normalised by the energy of the cells around it.
class Hog final : public Describer {
 public:
  explicit Hog(std::optional<Panorama> panorama) : Describer(std::move(panorama)) {}
  Eigen::Index dim() const override { return kColumns * kRows * kBins; }
  std::uint32_t name() const override { return 2; }

 private:
  static constexpr int kColumns = 16, kRows = 8, kBins = 9;
  static constexpr float kEnergyFloor = 100;  // of cells without structure [grey values^2]
  static constexpr float kMost = 0.4F;        // one strong edge does not outweigh all others
  cv::Size gridSize() const override { return {kColumns * kCell, kRows * kCell}; }

  Eigen::VectorXf ofGrid(const cv::Mat& grey) const override {
    const Eigen::MatrixXf cells = histograms(grey);
    const cv::Mat energy = energyAround(cells);
    Eigen::VectorXf v(dim());
    for (int c = 0; c < kColumns * kRows; ++c) {
      const float norm = std::sqrt(energy.at<float>(c / kRows, c % kRows) + kEnergyFloor);
      v.segment(c * kBins, kBins) = (cells.col(c) / norm).cwiseMin(kMost);
    }
    return v;
  }

  /// One column of bins for each cell, columns of the image first.
  static Eigen::MatrixXf histograms(const cv::Mat& grey) {
    cv::Mat dx, dy;
    cv::Sobel(grey, dx, CV_32F, 1, 0, 1);
    cv::Sobel(grey, dy, CV_32F, 0, 1, 1);
    Eigen::MatrixXf cells = Eigen::MatrixXf::Zero(kBins, kColumns * kRows);
    for (int y = 0; y < grey.rows; ++y)
      for (int x = 0; x < grey.cols; ++x) {
        const float gx = dx.at<float>(y, x), gy = dy.at<float>(y, x);
        const float direction = std::atan2(gy, gx) / std::numbers::pi_v<float> * kBins - 0.5F;
        const float lower = std::floor(direction), share = direction - lower;
        const int bin = (static_cast<int>(lower) + 2 * kBins) % kBins, cell = x / kCell * kRows + y / kCell;
        const float strength = std::hypot(gx, gy);
        cells(bin, cell) += (1 - share) * strength;
        cells((bin + 1) % kBins, cell) += share * strength;
      }
    return cells;
  }

  static cv::Mat energyAround(const Eigen::MatrixXf& cells) {
    cv::Mat energy(kColumns, kRows, CV_32F), around;
    for (int c = 0; c < kColumns * kRows; ++c)
      energy.at<float>(c / kRows, c % kRows) = cells.col(c).squaredNorm();
    cv::boxFilter(energy, around, CV_32F, {3, 3}, {-1, -1}, false, cv::BORDER_REPLICATE);
    return around;
  }
};

}  // namespace

void AppearanceParams::describe(base::Params& p) {
  p.addChoice(
      "channel", channel,
      "what the whole image says of the place, beside its features: nothing, its grey values patch by patch, "
      "or the directions of its gradients; needs [place] keep_thumbnails of 64 or more",
      {"none", "thumbnail", "hog"});
  p.add("evidence", evidence, "weight of one standard deviation of its similarities with all places [nat]",
        {0.01, 10});
  p.add("usual_similarity", usual_similarity, "similarity, from 0 to 1, that an unlike place shows", {0, 1});
  p.add("least_spread", least_spread, "lower bound of the standard deviation of the similarities", {1e-4, 1});
}

cv::Mat Describer::grid(const cv::Mat& picture) const {
  if (picture.empty()) throw base::Error("an image without pixels has no appearance");
  cv::Mat grey = picture, small;
  if (picture.channels() == 3) cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
  if (panorama_)
    small = panorama_->strip(grey, gridSize());
  else
    cv::resize(grey, small, gridSize(), 0, 0, cv::INTER_AREA);
  small.convertTo(small, CV_32F);
  return small;
}

Eigen::VectorXf Describer::normalised(const cv::Mat& grey) const {
  Eigen::VectorXf v = ofGrid(grey);
  v.array() -= v.mean();
  const float length = v.norm();
  return length > 0 ? Eigen::VectorXf(v / length) : v;
}

Eigen::VectorXf Describer::describe(const cv::Mat& picture) const { return normalised(grid(picture)); }

Signature Describer::describeQuery(const cv::Mat& picture) const {
  const cv::Mat straight = grid(picture);
  if (!panorama_) return normalised(straight);
  const int columns = straight.cols / kCell;
  const Eigen::Index block = dim() / columns;
  Signature all(dim(), columns * kHeadings);
  for (int within = 0; within < kHeadings; ++within) {
    const Eigen::VectorXf v = normalised(turned(straight, within * kCell / kHeadings));
    for (int shift = 0; shift < columns; ++shift) {
      auto column = all.col(within * columns + shift);
      column << v.tail(v.size() - shift * block), v.head(shift * block);
    }
  }
  return all;
}

std::unique_ptr<Describer> makeDescriber(const AppearanceParams& params, std::optional<Panorama> panorama) {
  base::validate(params);
  if (params.channel == "thumbnail") return std::make_unique<Thumbnail>(std::move(panorama));
  if (params.channel == "hog") return std::make_unique<Hog>(std::move(panorama));
  return nullptr;
}

}  // namespace engram::appearance
