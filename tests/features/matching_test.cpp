// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/features/matching.h"

#include "engram/base/rng.h"
#include "engram/features/place_matcher.h"
#include "matching_detail.h"
#include "nearest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <set>
#include <stdexcept>

namespace engram::features {
namespace {

using types::DescriptorKind;

std::vector<SimdLevel> levels() {
  std::vector<SimdLevel> all;
  for (int l = 0; l <= static_cast<int>(supportedSimd()); ++l) all.push_back(static_cast<SimdLevel>(l));
  return all;
}

/// Descriptors with many exact ties when `coarse`, else spread over all values.
types::Features randomFeatures(base::Rng& rng, DescriptorKind kind, int dim, int count, bool isSigned,
                               bool coarse) {
  types::Features f;
  f.descriptors = types::Descriptors(kind, dim);
  f.keypoints.resize(static_cast<std::size_t>(count));
  f.descriptors.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    if (isSigned) f.keypoints[std::size_t(i)].sign = rng.below(2) ? 1 : -1;
    std::byte* row = f.descriptors.mutableRow(std::size_t(i));
    for (int c = 0; c < dim; ++c) {
      if (kind == DescriptorKind::kFloat) {
        const float v = coarse ? float(int(rng.below(2))) : float(rng.uniform(-0.3, 0.3));
        std::memcpy(row + 4 * c, &v, 4);
      } else if (kind == DescriptorKind::kInt8) {
        row[c] = std::byte(coarse ? rng.below(2) : rng.below(256));
      } else if (rng.below(coarse ? 16 : 2) == 0) {
        row[c / 8] |= std::byte(1 << (c % 8));
      }
    }
  }
  return f;
}

/// The definition, straight from the descriptors. Squared for vectors.
float kernelDistance(const types::Descriptors& a, std::size_t i, const types::Descriptors& b, std::size_t j) {
  float sum = 0;
  switch (a.kind()) {
    case DescriptorKind::kFloat:
      for (int c = 0; c < a.dim(); ++c)
        sum += (a.floats(i)[c] - b.floats(j)[c]) * (a.floats(i)[c] - b.floats(j)[c]);
      break;
    case DescriptorKind::kInt8:
      for (int c = 0; c < a.dim(); ++c)
        sum += float((a.int8(i)[c] - b.int8(j)[c]) * (a.int8(i)[c] - b.int8(j)[c]));
      break;
    case DescriptorKind::kBinary:
      for (std::size_t w = 0; w < a.rowBytes() / 8; ++w)
        sum += float(std::popcount(a.words(i)[w] ^ b.words(j)[w]));
      break;
  }
  return sum;
}

float distance(float kernelValue, const types::Descriptors& d) {
  if (d.kind() == DescriptorKind::kBinary) return kernelValue / float(d.dim());
  return std::sqrt(kernelValue) / (d.kind() == DescriptorKind::kInt8 ? types::kInt8Scale : 1.0f);
}

bool allSigned(const types::Features& f) {
  return std::all_of(f.keypoints.begin(), f.keypoints.end(), [](const auto& k) { return k.sign != 0; });
}

struct Best {
  int index = -1;
  float first = INFINITY, second = INFINITY;
};

Best bruteNearest(const types::Features& a, std::size_t i, const types::Features& b) {
  const bool split = allSigned(a) && allSigned(b);
  Best best;
  for (std::size_t j = 0; j < b.size(); ++j) {
    if (split && a.keypoints[i].sign != b.keypoints[j].sign) continue;
    const float d = kernelDistance(a.descriptors, i, b.descriptors, j);
    if (d < best.first) {
      best = {int(j), d, best.first};
    } else {
      best.second = std::min(best.second, d);
    }
  }
  return best;
}

std::vector<types::Match> bruteMatch(const types::Features& a, const types::Features& b,
                                     const MatchParams& p) {
  const bool binary = a.descriptors.kind() == DescriptorKind::kBinary;
  std::vector<types::Match> out;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Best n = bruteNearest(a, i, b);
    if (n.index < 0) continue;
    const double factor = binary ? p.ratio : p.ratio * p.ratio;
    if (p.ratio < 1 && (std::isinf(n.second) || !(double(n.first) < factor * double(n.second)))) continue;
    const float d = distance(n.first, a.descriptors);
    if (p.max_distance > 0 && d > p.max_distance) continue;
    if (p.mutual && bruteNearest(b, std::size_t(n.index), a).index != int(i)) continue;
    const auto rival = std::find_if(out.begin(), out.end(), [&](const auto& m) { return m.b == n.index; });
    if (rival == out.end()) {
      out.push_back({int(i), n.index, d});
    } else if (d < rival->distance) {
      out.erase(rival);
      out.push_back({int(i), n.index, d});
    }
  }
  return out;
}

struct Layout {
  DescriptorKind kind;
  int dim;
};

class EveryKind : public testing::TestWithParam<Layout> {};

TEST_P(EveryKind, EqualsBruteForceAtEveryLevel) {
  base::Rng rng(11);
  const auto [kind, dim] = GetParam();
  for (int trial = 0; trial < 160; ++trial) {
    const bool coarse = trial % 2, signA = trial % 8 < 5, signB = trial % 4 < 3;
    const auto a = randomFeatures(rng, kind, dim, int(rng.below(71)), signA, coarse);
    const auto b = randomFeatures(rng, kind, dim, int(rng.below(71)), signB, coarse);
    MatchParams p;
    p.ratio = trial % 3 ? 0.97 : 1.0;
    p.mutual = trial % 5 < 3;
    p.max_distance = trial % 7 == 0 ? 0.45 : 0.0;
    const auto expected = bruteMatch(a, b, p);
    for (const SimdLevel level : levels())
      EXPECT_EQ(detail::matchPrepared(level, PreparedSet(a), PreparedSet(b), p), expected) << toString(level);
  }
}

TEST_P(EveryKind, NearestEqualsBruteForceAtEveryLevel) {
  base::Rng rng(12);
  const auto [kind, dim] = GetParam();
  for (int count = 1; count <= 70; ++count) {
    const auto a = randomFeatures(rng, kind, dim, 1 + int(rng.below(20)), false, count % 2);
    const auto b = randomFeatures(rng, kind, dim, count, false, count % 2);
    const PreparedSet queries(a), set(b);
    for (const SimdLevel level : levels()) {
      std::vector<Nearest> found(a.size());
      findNearest(level, kind, queries.groups[0], 0, int(a.size()), set.groups[0], found.data());
      for (std::size_t i = 0; i < a.size(); ++i) {
        const Best best = bruteNearest(a, i, b);
        EXPECT_EQ(found[i].row, best.index);
        EXPECT_EQ(found[i].first, best.first);
        EXPECT_EQ(found[i].second, best.second);
      }
    }
  }
}

TEST_P(EveryKind, IsOneToOneAndFindsItself) {
  base::Rng rng(13);
  const auto [kind, dim] = GetParam();
  const auto a = randomFeatures(rng, kind, dim, 60, true, false);
  const auto self = match(a, a, {});
  ASSERT_EQ(self.size(), a.size());
  for (const auto& m : self) {
    EXPECT_EQ(m.a, m.b);
    EXPECT_EQ(m.distance, 0.0f);
  }
  const auto b = randomFeatures(rng, kind, dim, 20, true, true);
  MatchParams greedy;
  greedy.ratio = 1;
  greedy.mutual = false;
  const auto matches = match(a, b, greedy);
  std::set<int> as, bs;
  for (const auto& m : matches) {
    as.insert(m.a);
    bs.insert(m.b);
  }
  EXPECT_EQ(as.size(), matches.size());
  EXPECT_EQ(bs.size(), matches.size());
}

TEST_P(EveryKind, PlaceMatcherEqualsMatchPlaceByPlace) {
  base::Rng rng(14);
  const auto [kind, dim] = GetParam();
  if (kind == DescriptorKind::kFloat) return;
  PlaceMatcher matcher;
  std::vector<types::Features> places(12);
  for (std::size_t p = 0; p < places.size(); ++p) {
    places[p] = randomFeatures(rng, kind, dim, int(rng.below(70)), true, false);
    matcher.set(p, randomFeatures(rng, kind, dim, 5, true, true));  // to be replaced
    matcher.set(p, places[p]);
  }
  auto query = randomFeatures(rng, kind, dim, 10, true, false);
  for (int i = 0; i < 40; ++i) {
    const auto& from = places[rng.below(12)];
    if (!from.empty()) query.append(from, rng.below(std::uint32_t(from.size())));
  }
  places[3] = types::Features{{}, types::Descriptors(kind, dim), {}};
  matcher.remove(3);
  MatchParams params;
  for (const bool mutual : {true, false}) {
    params.mutual = mutual;
    const auto counts = matcher.ratioMatchCounts(query, params, 1);
    EXPECT_EQ(counts, matcher.ratioMatchCounts(query, params, 3));
    ASSERT_EQ(counts.size(), places.size());
    for (std::size_t p = 0; p < places.size(); ++p) {
      EXPECT_EQ(counts[p], int(bruteMatch(query, places[p], params).size()));
      EXPECT_EQ(matcher.matches(query, p, params), bruteMatch(query, places[p], params));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Layouts, EveryKind,
                         testing::Values(Layout{DescriptorKind::kFloat, 64},
                                         Layout{DescriptorKind::kFloat, 5}, Layout{DescriptorKind::kInt8, 64},
                                         Layout{DescriptorKind::kInt8, 128}, Layout{DescriptorKind::kInt8, 7},
                                         Layout{DescriptorKind::kBinary, 486},
                                         Layout{DescriptorKind::kBinary, 256},
                                         Layout{DescriptorKind::kBinary, 2100}));

TEST(Match, WithoutSecondNearestOnlyTheSwitchedOffRatioAccepts) {
  base::Rng rng(1);
  const auto a = randomFeatures(rng, DescriptorKind::kInt8, 64, 1, true, false);
  EXPECT_TRUE(match(a, a, {}).empty());
  MatchParams p;
  p.ratio = 1.0;
  EXPECT_EQ(match(a, a, p).size(), 1u);
}

TEST(Match, ComparesEqualSignsOnly) {
  base::Rng rng(2);
  const auto a = randomFeatures(rng, DescriptorKind::kFloat, 64, 30, true, false);
  auto b = a;
  for (auto& k : b.keypoints) k.sign = static_cast<std::int8_t>(-k.sign);
  MatchParams p;
  p.max_distance = 0.01;
  EXPECT_TRUE(match(a, b, p).empty());
  for (auto& k : b.keypoints) k.sign = 0;
  EXPECT_EQ(match(a, b, p).size(), a.size());
}

TEST(Match, QuantisesAFloatSetAgainstABytesSet) {
  base::Rng rng(3);
  const auto a = randomFeatures(rng, DescriptorKind::kFloat, 64, 50, true, false);
  const auto b = detail::quantisedFeatures(a);
  EXPECT_EQ(match(a, b, {}), match(b, b, {}));
  EXPECT_EQ(match(b, a, {}), match(b, b, {}));
  EXPECT_EQ(match(b, a, {}).size(), 50u);
}

TEST(Match, RefusesOtherLayouts) {
  base::Rng rng(4);
  const auto a = randomFeatures(rng, DescriptorKind::kInt8, 64, 3, true, false);
  EXPECT_THROW(match(a, randomFeatures(rng, DescriptorKind::kInt8, 128, 3, true, false), {}),
               std::invalid_argument);
  EXPECT_THROW(match(a, randomFeatures(rng, DescriptorKind::kBinary, 64, 3, true, false), {}),
               std::invalid_argument);
  EXPECT_TRUE(match(a, types::Features{}, {}).empty());
  PlaceMatcher places;
  places.set(0, a);
  EXPECT_THROW(places.set(1, randomFeatures(rng, DescriptorKind::kInt8, 128, 3, true, false)),
               std::invalid_argument);
  EXPECT_THROW(places.matches(a, 7, {}), std::invalid_argument);
}

// Rounding to 1/254 errs by at most 1/508 a component, so a distance errs by at most 2 sqrt(dim) / 508
// (triangle inequality); uniform independent errors give a standard deviation of about sqrt(1/6)/254 whatever
// the dimension.
TEST(Quantisation, KeepsDistancesWithinItsBound) {
  base::Rng rng(5);
  for (const int dim : {64, 128}) {
    types::Features f;
    f.descriptors = types::Descriptors(DescriptorKind::kFloat, dim);
    for (int i = 0; i < 100; ++i) {
      std::vector<float> v(static_cast<std::size_t>(dim));
      double norm = 0;
      for (float& c : v) {
        c = float(rng.normal());
        norm += double(c) * c;
      }
      for (float& c : v) c /= float(std::sqrt(norm));
      ASSERT_LT(*std::max_element(v.begin(), v.end()), 0.5f);
      f.descriptors.append(std::as_bytes(std::span(v)));
    }
    const auto q = types::quantised(f.descriptors);
    const double bound = 2 * std::sqrt(double(dim)) / 508;
    double squares = 0;
    int pairs = 0;
    for (std::size_t i = 0; i < 100; ++i)
      for (std::size_t j = 0; j < i; ++j, ++pairs) {
        const double exact = distance(kernelDistance(f.descriptors, i, f.descriptors, j), f.descriptors);
        const double error = distance(kernelDistance(q, i, q, j), q) - exact;
        EXPECT_LE(std::abs(error), bound);
        squares += error * error;
      }
    EXPECT_LT(std::sqrt(squares / pairs), 1.3 * std::sqrt(1.0 / 6) / 254);
  }
}

}  // namespace
}  // namespace engram::features
