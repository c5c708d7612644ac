// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/memory/static_view.h"

#include "make_features.h"

#include <gtest/gtest.h>

namespace engram::memory {
namespace {

TEST(Static, HoldsTheWholeFirstViewAsLongTermForEver) {
  const Static model;
  const auto view = makeFeatures({1, 2, 3}, {9, 1, 0});
  auto memory = model.start(view);
  EXPECT_EQ(memory.longTerm(), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(memory.features.descriptors.kind(), types::DescriptorKind::kInt8);
  EXPECT_EQ(memory.features.descriptors, types::quantised(view.descriptors));

  const auto before = memory;
  for (int k = 0; k < 20; ++k) {
    const auto other = makeFeatures({3, 70 + k}, {1, 1});
    const auto change = model.update(memory, other, trueMatches(other, memory, 0.1f));
    EXPECT_EQ(change.rehearsed + change.added + change.pruned + change.promoted + change.demoted, 0);
    EXPECT_EQ(change.longTerm, 3);
    EXPECT_EQ(change.shortTerm, 0);
  }
  EXPECT_EQ(memory.states, before.states);
  EXPECT_EQ(memory.features.descriptors, before.features.descriptors);
  EXPECT_EQ(memory.updates, before.updates);
}

}  // namespace
}  // namespace engram::memory
