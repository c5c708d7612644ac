// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/types/features.h"

#include "engram/base/rng.h"
#include "engram/types/frame_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace engram::types {
namespace {

Descriptors floatRows(const std::vector<std::vector<float>>& rows) {
  Descriptors out(DescriptorKind::kFloat, static_cast<int>(rows.front().size()));
  for (const auto& row : rows) out.append(std::as_bytes(std::span(row)));
  return out;
}

Features sample(int n, bool bearings) {
  Features out;
  out.descriptors = Descriptors(DescriptorKind::kInt8, 4);
  for (int i = 0; i < n; ++i) {
    Keypoint keypoint;
    keypoint.x = static_cast<float>(i);
    out.keypoints.push_back(keypoint);
    const std::vector<std::byte> row(4, static_cast<std::byte>(i));
    out.descriptors.append(row);
    if (bearings) out.bearings.emplace_back(0.f, 0.f, static_cast<float>(i));
  }
  return out;
}

TEST(Descriptors, KnowTheSizeOfARow) {
  EXPECT_EQ(Descriptors(DescriptorKind::kFloat, 64).rowBytes(), 256u);
  EXPECT_EQ(Descriptors(DescriptorKind::kInt8, 64).rowBytes(), 64u);
  EXPECT_EQ(Descriptors(DescriptorKind::kBinary, 256).rowBytes(), 32u);
  EXPECT_EQ(Descriptors(DescriptorKind::kBinary, 486).rowBytes(), 64u) << "padded to words";
  EXPECT_EQ(Descriptors().size(), 0u);
}

TEST(Descriptors, AreContiguousRows) {
  const auto d = floatRows({{1, 2}, {3, 4}, {5, 6}});
  EXPECT_EQ(d.size(), 3u);
  EXPECT_EQ(d.floats(1), d.floats(0) + 2);
  EXPECT_EQ(d.floats(2)[1], 6.0f);
  Descriptors resized = d;
  resized.resize(1);
  EXPECT_EQ(resized, floatRows({{1, 2}}));
  EXPECT_TRUE(d.sameLayout(resized));
  EXPECT_FALSE(d.sameLayout(Descriptors(DescriptorKind::kFloat, 3)));
  EXPECT_FALSE(d.sameLayout(Descriptors(DescriptorKind::kInt8, 2)));
}

TEST(Quantised, RoundsAndSaturates) {
  const auto q = quantised(floatRows({{0.0f, 0.1f, -0.1f, 0.5f, 0.9f, -1.0f}}));
  ASSERT_EQ(q.kind(), DescriptorKind::kInt8);
  const std::vector<std::int8_t> expected{0, 25, -25, 127, 127, -127};
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), q.int8(0)));
}

TEST(Quantised, KeepsDistancesToWithinTheStep) {
  base::Rng rng(1);
  constexpr int kDim = 64;
  std::vector<std::vector<float>> rows(40, std::vector<float>(kDim));
  for (auto& row : rows) {
    double norm = 0;
    for (float& x : row) norm += std::pow(x = static_cast<float>(rng.normal()), 2);
    for (float& x : row) x /= static_cast<float>(std::sqrt(norm));
  }
  const auto exact = floatRows(rows);
  const auto q = quantised(exact);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      double d = 0, dq = 0;
      for (int k = 0; k < kDim; ++k) {
        d += std::pow(exact.floats(i)[k] - exact.floats(j)[k], 2);
        dq += std::pow((q.int8(i)[k] - q.int8(j)[k]) / kInt8Scale, 2);
      }
      // Each component is off by half a step at most, so the difference of two by a whole one.
      ASSERT_NEAR(std::sqrt(d), std::sqrt(dq), std::sqrt(kDim) / kInt8Scale);
    }
}

TEST(Quantised, LeavesOtherKindsAlone) {
  Descriptors binary(DescriptorKind::kBinary, 100);
  binary.resize(2);
  *binary.mutableRow(1) = std::byte{0xAB};
  EXPECT_EQ(quantised(binary), binary);
  const auto once = quantised(floatRows({{0.1f, 0.2f}}));
  EXPECT_EQ(quantised(once), once);
}

TEST(Features, SubsetKeepsTheOrderAsked) {
  const auto all = sample(5, true);
  const std::vector<int> indices{4, 0, 4};
  const auto some = all.subset(indices);
  ASSERT_EQ(some.size(), 3u);
  ASSERT_EQ(some.descriptors.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(some.keypoints[i].x, static_cast<float>(indices[i]));
    EXPECT_EQ(some.descriptors.int8(i)[3], indices[i]);
    EXPECT_EQ(some.bearings[i].z(), static_cast<float>(indices[i]));
  }
  EXPECT_TRUE(sample(5, false).subset(indices).bearings.empty());
  const auto none = all.subset({});
  EXPECT_TRUE(none.empty());
  EXPECT_TRUE(none.descriptors.sameLayout(all.descriptors));
}

TEST(Features, AppendTakesTheLayoutOrRefusesAnother) {
  Features out;
  out.append(sample(3, true), 2);
  EXPECT_EQ(out.size(), 1u);
  EXPECT_EQ(out.descriptors.int8(0)[0], 2);
  EXPECT_EQ(out.bearings.size(), 1u);
  Features other;
  other.descriptors = Descriptors(DescriptorKind::kInt8, 8);
  other.descriptors.resize(1);
  other.keypoints.resize(1);
  EXPECT_THROW(out.append(other, 0), std::invalid_argument);
  EXPECT_EQ(out.size(), 1u);
}

TEST(Features, RangesStayParallelWhoeverKnowsThem) {
  Features ranged = sample(3, false), other = sample(3, false);
  ranged.ranges = {1, 2, 3};
  Features out;
  out.append(other, 0);
  EXPECT_TRUE(out.ranges.empty());
  out.append(ranged, 1);
  EXPECT_EQ(out.ranges, (std::vector<float>{0, 2}));
  out.append(other, 2);
  EXPECT_EQ(out.ranges, (std::vector<float>{0, 2, 0}));
  EXPECT_EQ(out.subset(std::vector<int>{1, 2}).ranges, (std::vector<float>{2, 0}));
}

TEST(Outcome, HasANameForEachValue) {
  std::set<std::string> names;
  for (const auto outcome :
       {Outcome::kSkipped, Outcome::kUnusable, Outcome::kNewPlace, Outcome::kRecognised, Outcome::kRefused})
    names.insert(toString(outcome));
  EXPECT_EQ(names.size(), 5u);
  EXPECT_EQ(names.count("?"), 0u);
}

}  // namespace
}  // namespace engram::types
