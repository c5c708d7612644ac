// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/appearance/signature_index.h"

#include <algorithm>
#include <stdexcept>

namespace engram::appearance {

void SignatureIndex::reserve(std::size_t places) {
  const auto before = rows_.rows(), after = static_cast<Eigen::Index>(places);
  if (after <= before) return;
  rows_.conservativeResize(after, dim_);
  rows_.bottomRows(after - before).setZero();
}

void SignatureIndex::set(std::size_t place, const Eigen::VectorXf& signature) {
  if (signature.size() != dim_) throw std::invalid_argument("SignatureIndex: another dimension");
  const auto room = static_cast<std::size_t>(rows_.rows());
  if (place >= room) reserve(std::max(place + 1, 2 * room));
  rows_.row(static_cast<Eigen::Index>(place)) = signature.transpose();
  size_ = std::max(size_, place + 1);
}

std::vector<double> SignatureIndex::similarities(const Signature& query) const {
  if (query.rows() != dim_) throw std::invalid_argument("SignatureIndex: another dimension");
  std::vector<double> result(size_, 0.5);
  if (size_ == 0) return result;
  const Eigen::VectorXf best = (rows_.topRows(static_cast<Eigen::Index>(size_)) * query).rowwise().maxCoeff();
  for (std::size_t i = 0; i < size_; ++i)
    result[i] = std::clamp(0.5 + 0.5 * static_cast<double>(best[static_cast<Eigen::Index>(i)]), 0.0, 1.0);
  return result;
}

}  // namespace engram::appearance
