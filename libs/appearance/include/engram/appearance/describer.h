// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/appearance/panorama.h"
#include "engram/base/params.h"

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace engram::appearance {

/// Section `[appearance]`: the whole image as evidence beside its features.
struct AppearanceParams {
  std::string channel = "none";
  double evidence = 0.5;          ///< [nat] a standard deviation of the image's own correlations
  double usual_similarity = 0.6;  ///< what an unlike place shows: counts in maps of few places
  double least_spread = 0.03;     ///< of the similarities

  void describe(base::Params& p);
};

/// An image as vectors of mean 0 and length 1, to be compared by their scalar product: one a column. Of a
/// place there is one; of a query as many as there are headings to try.
using Signature = Eigen::MatrixXf;

/// Turns pictures, however small, into signatures. The same picture gives the same bytes.
class Describer {
 public:
  virtual ~Describer() = default;

  virtual Eigen::Index dim() const = 0;
  /// Signatures of describers of different names must not be compared. It changes with what they compute.
  virtual std::uint32_t name() const = 0;

  /// @param picture 8 bit, 1 or 3 (BGR) channels: of the camera, or scaled down. Throws base::Error when it
  /// is empty.
  Eigen::VectorXf describe(const cv::Mat& picture) const;
  /// The same for a picture whose heading is not known: with a camera that sees all round one column for
  /// each heading, otherwise one column.
  Signature describeQuery(const cv::Mat& picture) const;

 protected:
  explicit Describer(std::optional<Panorama> panorama) : panorama_(std::move(panorama)) {}

 private:
  /// @param grey CV_32F of gridSize()
  virtual Eigen::VectorXf ofGrid(const cv::Mat& grey) const = 0;
  virtual cv::Size gridSize() const = 0;
  cv::Mat grid(const cv::Mat& picture) const;
  Eigen::VectorXf normalised(const cv::Mat& grey) const;

  std::optional<Panorama> panorama_;
};

/// By `channel`: `thumbnail`, the grey values of 64 x 32 pixels, each patch of 8 x 8 normalised; `hog`,
/// histograms of the directions of the gradients in 16 x 8 cells. None for `none`.
/// @param panorama how the camera is unwrapped, when it sees all round. Throws base::ConfigError.
std::unique_ptr<Describer> makeDescriber(const AppearanceParams& params,
                                         std::optional<Panorama> panorama = {});

}  // namespace engram::appearance
