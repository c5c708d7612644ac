// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tf_idf.h"

#include <algorithm>

namespace engram::vocabulary {

Eigen::VectorXd countWords(std::span<const int> words, int dictionarySize) {
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(dictionarySize);
  for (const int w : words) counts[w] += 1;
  return counts;
}

Eigen::VectorXd inverseDocumentFrequency(std::span<const Eigen::VectorXd> counts, int dictionarySize) {
  Eigen::ArrayXd images = Eigen::ArrayXd::Zero(dictionarySize);
  for (const Eigen::VectorXd& c : counts) images += (c.array() > 0).cast<double>();
  const auto total = static_cast<double>(counts.size());
  return (images > 0).select((total / images.max(1.0)).log(), 0.0);
}

Eigen::VectorXd tfIdf(const Eigen::VectorXd& counts, const Eigen::VectorXd& idf) {
  return counts.cwiseProduct(idf) / std::max(1.0, counts.sum());
}

double cosineSimilarity(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const double norms = a.norm() * b.norm();
  // The bound takes away the last bit of rounding.
  return norms > 0 ? std::min(1.0, a.dot(b) / norms) : 0.0;
}

}  // namespace engram::vocabulary
