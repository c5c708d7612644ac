// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/types/features.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace engram::vocabulary {

/// Section `[bow]`: the bag-of-words baseline of F-27.
struct BowParams {
  int words = 80;            ///< centres of the dictionary; the paper has as many as places
  int max_training = 50000;  ///< descriptors that the centres are trained on, drawn by the seed
  int iterations = 20;       ///< of k-means, at most
  int seed = 1;

  void describe(base::Params& p);
};

/// A dictionary of visual words by k-means (Lloyd, k-means++ start), trained as a whole (F-27).
class KMeansDictionary {
 public:
  /// Trains on the descriptors of all images together. kInt8 ones are compared as the floats they stand for.
  /// The result depends on the seed and the descriptors only. There are fewer words than asked for when
  /// there are fewer descriptors.
  /// @throws base::Error on binary descriptors, on ones of different dimensions and when there are none.
  /// @throws base::ConfigError when a parameter is out of range.
  KMeansDictionary(std::span<const types::Descriptors* const> images, const BowParams& params);

  int size() const { return static_cast<int>(centres_.rows()); }
  int dim() const { return static_cast<int>(centres_.cols()); }
  using Centres = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Centres& centres() const { return centres_; }  ///< one row a word

  /// For each descriptor the nearest centre, exactly; ties: the lower number.
  /// @throws base::Error when the descriptors are binary or of another dimension. No descriptors, no words.
  std::vector<int> wordsOf(const types::Descriptors& descriptors) const;

 private:
  Centres centres_;
  Eigen::VectorXf halfSquares_;  // |c|² / 2 of each centre
};

}  // namespace engram::vocabulary
