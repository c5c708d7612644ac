// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "replace.h"

#include "make_features.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

namespace engram::memory {
namespace {

TEST(Replace, HoldsTheLatestViewAloneUnderNewIds) {
  const Replace model;
  auto memory = model.start(makeFeatures({1, 2, 3}, {9, 1, 0}));
  std::set<std::uint32_t> used;
  for (int n = 1; n < 10; ++n) {
    for (const auto& state : memory.states) EXPECT_TRUE(used.insert(state.id).second) << "an id came back";
    const auto before = memory.states.size();
    const auto view = makeFeatures({2, 3, 10 + n, 20 + n}, {1, 2, 3, 4});
    const auto change = model.update(memory, view, trueMatches(view, memory, 0.1f));
    EXPECT_EQ(memory.features.descriptors, types::quantised(view.descriptors));
    EXPECT_EQ(memory.longTerm(), (std::vector<int>{0, 1, 2, 3}));
    EXPECT_EQ(change.added, 4);
    EXPECT_EQ(change.pruned, static_cast<int>(before));
    EXPECT_EQ(change.longTerm, 4);
    EXPECT_EQ(memory.updates, static_cast<std::uint32_t>(n + 1));
    for (const auto& state : memory.states) EXPECT_LT(state.id, memory.nextFeatureId);
  }
}

TEST(Replace, AnEmptyViewReplacesNothingAndWrongMatchesAreRefused) {
  const Replace model;
  const auto view = makeFeatures({1, 2}, {9, 1});
  auto memory = model.start(view);
  EXPECT_EQ(model.update(memory, {}, {}).longTerm, 2);
  EXPECT_EQ(memory.features.size(), 2u);
  const std::vector<types::Match> twice{{0, 0, 0.1f}, {1, 0, 0.1f}};
  EXPECT_THROW(model.update(memory, view, twice), std::invalid_argument);
  EXPECT_EQ(memory.updates, 2u);
}

}  // namespace
}  // namespace engram::memory
