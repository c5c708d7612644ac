// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/appearance/signature_index.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace engram::appearance {
namespace {

TEST(SignatureIndex, IsTheBestCorrelationOfEveryPlace) {
  std::srand(1);  // of Eigen's Random
  SignatureIndex index(40);
  std::vector<Eigen::VectorXf> all;
  for (std::size_t i = 0; i < 30; ++i) {
    all.emplace_back(Eigen::VectorXf::Random(40).normalized());
    index.set(i, all.back());
  }
  all[7] = Eigen::VectorXf::Random(40).normalized();
  index.set(7, all[7]);
  Signature query(40, 3);
  for (int c = 0; c < 3; ++c) query.col(c) = Eigen::VectorXf::Random(40).normalized();
  const auto found = index.similarities(query);
  ASSERT_EQ(found.size(), 30u);
  for (std::size_t i = 0; i < 30; ++i) {
    float best = -1;
    for (int c = 0; c < 3; ++c) best = std::max(best, all[i].dot(query.col(c)));
    EXPECT_NEAR(found[i], 0.5 + 0.5 * static_cast<double>(best), 1e-6);
  }
}

TEST(SignatureIndex, PlacesWithoutASignatureAreLikeNothing) {
  SignatureIndex index(3);
  EXPECT_TRUE(index.similarities(Eigen::Vector3f::UnitX()).empty());
  index.set(2, Eigen::Vector3f::UnitX());
  EXPECT_EQ(index.similarities(Eigen::Vector3f::UnitX()), (std::vector<double>{0.5, 0.5, 1.0}));
}

TEST(SignatureIndex, RefusesAnotherDimension) {
  SignatureIndex index(3);
  EXPECT_THROW(index.set(0, Eigen::Vector2f::UnitX()), std::invalid_argument);
  EXPECT_THROW(index.similarities(Eigen::Vector2f::UnitX()), std::invalid_argument);
}

}  // namespace
}  // namespace engram::appearance
