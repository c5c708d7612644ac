// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/appearance/describer.h"

#include <cstddef>
#include <vector>

namespace engram::appearance {

/// The signatures of the places of a map, by index, for one matrix product a query.
class SignatureIndex {
 public:
  explicit SignatureIndex(Eigen::Index dim) : dim_(dim) {}

  std::size_t size() const { return size_; }
  /// Room for so many places.
  void reserve(std::size_t places);
  Eigen::VectorXf signature(std::size_t place) const {
    return rows_.row(static_cast<Eigen::Index>(place)).transpose();
  }
  /// A place beyond the last one is added, and those between have no signature: they are like nothing.
  /// Throws std::invalid_argument for another dimension.
  void set(std::size_t place, const Eigen::VectorXf& signature);

  /// Similarity of each place, (1 + c) / 2 of the largest correlation c over the columns of the query.
  std::vector<double> similarities(const Signature& query) const;

 private:
  Eigen::Index dim_;
  std::size_t size_ = 0;
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows_;  // with room to grow
};

}  // namespace engram::appearance
