// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/features/row_set.h"

#include "engram/base/rng.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <stdexcept>
#include <vector>

namespace engram::features {
namespace {

using types::DescriptorKind;
using types::Descriptors;

Descriptors randomRows(DescriptorKind kind, int dim, std::size_t n, base::Rng& rng) {
  Descriptors rows(kind, dim);
  rows.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::byte* row = rows.mutableRow(i);
    const std::size_t bytes =
        kind == DescriptorKind::kBinary ? static_cast<std::size_t>(dim) / 8 : rows.rowBytes();
    // Few values: ties are common.
    for (std::size_t b = 0; b < bytes; ++b) row[b] = static_cast<std::byte>(rng.below(3));
  }
  return rows;
}

long distance(const Descriptors& a, std::size_t i, const Descriptors& b, std::size_t j) {
  long sum = 0;
  if (a.kind() == DescriptorKind::kBinary) {
    for (std::size_t w = 0; w < a.rowBytes() / 8; ++w) sum += std::popcount(a.words(i)[w] ^ b.words(j)[w]);
    return sum;
  }
  for (int c = 0; c < a.dim(); ++c) {
    const long d = a.int8(i)[c] - b.int8(j)[c];
    sum += d * d;
  }
  return sum;
}

int nearest(const Descriptors& queries, std::size_t i, const Descriptors& rows) {
  int best = -1;
  long least = std::numeric_limits<long>::max();
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const long d = distance(queries, i, rows, j);
    if (d < least) least = d, best = static_cast<int>(j);
  }
  return best;
}

TEST(RowSet, FindsTheNearestAsBruteForceDoes) {
  base::Rng rng(4);
  for (const auto& [kind, dim] :
       {std::pair{DescriptorKind::kInt8, 64}, {DescriptorKind::kInt8, 20}, {DescriptorKind::kBinary, 256}})
    for (const std::size_t n : {1, 2, 16, 37, 130}) {
      const Descriptors rows = randomRows(kind, dim, n, rng), queries = randomRows(kind, dim, 45, rng);
      const RowSet set(rows), asked(queries);
      EXPECT_EQ(set.size(), n);
      std::vector<int> some(30);
      set.nearest(asked, 11, some);
      for (std::size_t i = 0; i < some.size(); ++i)
        ASSERT_EQ(some[i], nearest(queries, 11 + i, rows)) << dim << ' ' << n << ' ' << i;
    }
}

TEST(RowSet, RefusesWhatCannotBeCompared) {
  base::Rng rng(5);
  const RowSet vectors(randomRows(DescriptorKind::kInt8, 64, 3, rng));
  const RowSet bits(randomRows(DescriptorKind::kBinary, 256, 3, rng));
  std::vector<int> out(2), tooMany(4);
  EXPECT_THROW(vectors.nearest(bits, 0, out), std::invalid_argument);
  EXPECT_THROW(vectors.nearest(vectors, 0, tooMany), std::invalid_argument);
  EXPECT_THROW(vectors.nearest(vectors, 2, out), std::invalid_argument);
  RowSet(Descriptors(DescriptorKind::kInt8, 64)).nearest(vectors, 0, out);
  EXPECT_EQ(out, std::vector<int>(2, -1));
}

}  // namespace
}  // namespace engram::features
