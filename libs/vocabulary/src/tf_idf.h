// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

namespace engram::vocabulary {

/// Occurrences of each word of a dictionary in one image: n_wi of F eq (12).
Eigen::VectorXd countWords(std::span<const int> words, int dictionarySize);

/// log(N / n_w) of each word over the images of a collection, one vector of counts for each. A word that no
/// image holds has 0: it cannot tell images apart.
Eigen::VectorXd inverseDocumentFrequency(std::span<const Eigen::VectorXd> counts, int dictionarySize);

/// n_wi / n_i * log(N / n_w), F eq (12). Zero for an image without words.
Eigen::VectorXd tfIdf(const Eigen::VectorXd& counts, const Eigen::VectorXd& idf);

/// In [0, 1] for vectors without negative components; 0 when one of them is zero.
double cosineSimilarity(const Eigen::VectorXd& a, const Eigen::VectorXd& b);

}  // namespace engram::vocabulary
