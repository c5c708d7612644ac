// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "place_words.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <utility>

namespace engram::pipeline {
namespace {

using features::RowSet;
using types::DescriptorKind;
using types::Descriptors;

constexpr std::size_t kCells = 128;        // and words in each, at most
constexpr std::size_t kRowsPerWord = 4;    // that training needs, on average
constexpr std::size_t kBits = 64;          // of a signature
constexpr int kRounds = 8;                 // of k-means
constexpr std::size_t kRowsPerCell = 512;  // that the cells are trained on: more do not move them

Descriptors chosen(const Descriptors& rows, const std::vector<std::uint32_t>& which) {
  Descriptors out(rows.kind(), rows.dim());
  out.reserve(which.size());
  for (const std::uint32_t i : which) out.append(rows.row(i));
  return out;
}

/// Up to so many of the rows, drawn without repetition.
Descriptors drawn(const Descriptors& rows, std::size_t most, base::Rng rng) {
  std::vector<std::uint32_t> order(rows.size());
  std::iota(order.begin(), order.end(), 0u);
  const std::size_t n = std::min(most, order.size());
  for (std::size_t k = 0; k < n; ++k)
    std::swap(order[k], order[k + rng.below(static_cast<std::uint32_t>(order.size() - k))]);
  order.resize(n);
  return chosen(rows, order);
}

std::vector<int> nearest(const RowSet& centres, const RowSet& rows) {
  std::vector<int> result(rows.size());
  centres.nearest(rows, 0, result);
  return result;
}

/// Sums of the components, or of the bits, of the rows of each cluster.
class Sums {
 public:
  Sums(const Descriptors& rows, std::size_t clusters)
      : rows_(rows), sums_(clusters * static_cast<std::size_t>(rows.dim()), 0), counts_(clusters, 0) {}

  void add(std::size_t row, std::size_t cluster) {
    ++counts_[cluster];
    int* sum = of(cluster);
    const auto dim = static_cast<std::size_t>(rows_.dim());
    if (rows_.kind() == DescriptorKind::kBinary) {
      const std::uint64_t* words = rows_.words(row);
      for (std::size_t c = 0; c < dim; ++c) sum[c] += static_cast<int>(words[c / 64] >> (c % 64) & 1);
    } else {
      const std::int8_t* values = rows_.int8(row);
      for (std::size_t c = 0; c < dim; ++c) sum[c] += values[c];
    }
  }

  /// The mean, or the majority of each bit; a cluster without rows keeps its centre.
  void writeCentre(std::size_t cluster, std::byte* out) {
    const int n = counts_[cluster];
    if (n == 0) return;
    const int* sum = of(cluster);
    const auto dim = static_cast<std::size_t>(rows_.dim());
    if (rows_.kind() == DescriptorKind::kBinary) {
      std::memset(out, 0, rows_.rowBytes());
      auto* words = reinterpret_cast<std::uint64_t*>(out);
      for (std::size_t c = 0; c < dim; ++c) words[c / 64] |= std::uint64_t{2 * sum[c] > n} << (c % 64);
    } else {
      auto* values = reinterpret_cast<std::int8_t*>(out);
      for (std::size_t c = 0; c < dim; ++c)
        values[c] = static_cast<std::int8_t>(std::lround(static_cast<double>(sum[c]) / n));
    }
  }

 private:
  int* of(std::size_t cluster) { return sums_.data() + cluster * static_cast<std::size_t>(rows_.dim()); }

  const Descriptors& rows_;
  std::vector<int> sums_, counts_;
};

/// Lloyd's algorithm from centres drawn among the rows.
Descriptors kMeans(const Descriptors& rows, std::size_t k, base::Rng rng) {
  Descriptors centres = drawn(rows, k, rng);
  const RowSet asked(rows);
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<int> cluster = nearest(RowSet(centres), asked);
    Sums sums(rows, centres.size());
    for (std::size_t i = 0; i < cluster.size(); ++i) sums.add(i, static_cast<std::size_t>(cluster[i]));
    for (std::size_t c = 0; c < centres.size(); ++c) sums.writeCentre(c, centres.mutableRow(c));
  }
  return centres;
}

/// FNV-1a.
constexpr std::uint64_t kHashStart = 0xcbf29ce484222325;
std::uint64_t hashed(const Descriptors& rows, std::uint64_t hash) {
  for (const std::byte b : rows.bytes()) hash = (hash ^ static_cast<std::uint64_t>(b)) * 0x100000001b3;
  return (hash ^ rows.size()) * 0x100000001b3;
}

}  // namespace

PlaceWords::PlaceWords(Descriptors cells, std::vector<Descriptors> centres)
    : cellCentres_(std::move(cells)), cells_(cellCentres_), centres_(std::move(centres)) {
  tag_ = hashed(cellCentres_, kHashStart);
  for (const Descriptors& cell : centres_) {
    words_.emplace_back(cell);
    first_.push_back(static_cast<std::uint32_t>(size_));
    size_ += 2 * cell.size();
    tag_ = hashed(cell, tag_);
  }
}

PlaceWords PlaceWords::train(const Descriptors& sample, std::uint64_t seed) {
  const base::Rng rng(seed);
  const std::size_t cells = std::clamp<std::size_t>(sample.size() / 64, 1, kCells);
  Descriptors centres = kMeans(drawn(sample, cells * kRowsPerCell, rng.fork(0)), cells, rng.fork(1));
  const RowSet coarse(centres);
  std::vector<std::vector<std::uint32_t>> members(centres.size());
  const std::vector<int> cell = nearest(coarse, RowSet(sample));
  for (std::uint32_t i = 0; i < cell.size(); ++i) members[static_cast<std::size_t>(cell[i])].push_back(i);
  std::vector<Descriptors> fine;
  for (std::size_t c = 0; c < members.size(); ++c) {
    if (members[c].empty()) {  // its centre is its word
      fine.push_back(chosen(centres, {static_cast<std::uint32_t>(c)}));
      continue;
    }
    const std::size_t words = std::clamp<std::size_t>(members[c].size() / kRowsPerWord, 1, kCells);
    fine.push_back(kMeans(chosen(sample, members[c]), words, rng.fork(2 + c)));
  }
  return {std::move(centres), std::move(fine)};
}

std::uint64_t PlaceWords::signature(const Descriptors& rows, std::size_t row, std::size_t cell,
                                    std::size_t word) const {
  const auto dim = static_cast<std::size_t>(rows.dim());
  std::uint64_t bits = 0;
  if (rows.kind() == DescriptorKind::kBinary) {
    const std::uint64_t* values = rows.words(row);
    for (std::size_t b = 0; b < kBits; ++b) {
      const std::size_t c = b * dim / kBits;
      bits |= (values[c / 64] >> (c % 64) & 1) << b;
    }
  } else {
    const std::int8_t *values = rows.int8(row), *centre = centres_[cell].int8(word);
    for (std::size_t b = 0; b < kBits; ++b) {
      const std::size_t c = b * dim / kBits;
      bits |= std::uint64_t{values[c] > centre[c]} << b;
    }
  }
  return bits;
}

std::vector<PlaceWord> PlaceWords::wordsOf(const types::Features& features) const {
  const Descriptors rows = types::quantised(features.descriptors);
  const std::vector<int> cell = nearest(cells_, RowSet(rows));
  std::vector<std::uint32_t> order(rows.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return cell[a] < cell[b]; });
  const RowSet sorted(chosen(rows, order));
  std::vector<PlaceWord> result(rows.size());
  std::vector<int> found;
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    const auto c = static_cast<std::size_t>(cell[order[begin]]);
    while (end < order.size() && static_cast<std::size_t>(cell[order[end]]) == c) ++end;
    found.resize(end - begin);
    words_[c].nearest(sorted, begin, found);
    for (std::size_t k = begin; k < end; ++k) {
      const auto word = static_cast<std::uint32_t>(found[k - begin]);
      const std::uint32_t bright = features.keypoints[order[k]].sign > 0 ? 1 : 0;
      result[order[k]] = {first_[c] + 2 * word + bright, signature(rows, order[k], c, word)};
    }
  }
  return result;
}

}  // namespace engram::pipeline
