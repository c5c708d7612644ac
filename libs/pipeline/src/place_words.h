// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/rng.h"
#include "engram/features/row_set.h"
#include "engram/types/features.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace engram::pipeline {

/// A feature as an index knows it.
struct PlaceWord {
  std::uint32_t word = 0;
  std::uint64_t signature = 0;  ///< on which side of the word it is, component by component
  bool operator==(const PlaceWord&) const = default;
};

/// A vocabulary in two steps: a descriptor belongs to the nearest cell, and there to the nearest word. It is
/// searched by the kernels of the matcher, so that the words of an image cost a fraction of a millisecond.
/// Features of different sign of the Laplacian, which never match, have different words. Signatures tell
/// features of one word apart: the more bits differ, the farther they are (H. Jegou, M. Douze and C. Schmid,
/// Hamming embedding and weak geometric consistency for large scale image search, ECCV 2008; the components
/// themselves instead of projections, the word instead of medians).
class PlaceWords {
 public:
  /// k-means on these descriptors, kInt8 or kBinary; at least one. The result depends on them and the seed
  /// alone.
  static PlaceWords train(const types::Descriptors& sample, std::uint64_t seed);

  /// The word of each feature. Throws std::invalid_argument for descriptors of another kind or dimension.
  std::vector<PlaceWord> wordsOf(const types::Features& features) const;

  std::size_t size() const { return size_; }  ///< words are 0 … size() - 1

  /// From what cells() and centres() gave: centres of the cells, and of the words of each, none empty.
  PlaceWords(types::Descriptors cells, std::vector<types::Descriptors> centres);
  const types::Descriptors& cells() const { return cellCentres_; }
  const std::vector<types::Descriptors>& centres() const { return centres_; }
  /// Equal for equal words; others differ but for an accident in 2^64.
  std::uint64_t tag() const { return tag_; }

 private:
  std::uint64_t signature(const types::Descriptors& rows, std::size_t row, std::size_t cell,
                          std::size_t word) const;

  types::Descriptors cellCentres_;
  features::RowSet cells_;                   // the same for the kernels
  std::vector<types::Descriptors> centres_;  // of the words of each cell,
  std::vector<features::RowSet> words_;      // the same for the kernels,
  std::vector<std::uint32_t> first_;         // and the first word
  std::size_t size_ = 0;
  std::uint64_t tag_ = 0;
};

}  // namespace engram::pipeline
