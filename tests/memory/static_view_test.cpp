// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/memory/static_view.h"

#include "engram/base/config.h"
#include "engram/base/error.h"
#include "make_features.h"

#include <gmock/gmock.h>
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

TEST(MakeMemoryModel, ChoosesByName) {
  MemoryParams params;
  EXPECT_NE(dynamic_cast<Fsh*>(makeMemoryModel(params, {}).get()), nullptr);
  params.memory = "static";
  EXPECT_NE(dynamic_cast<Static*>(makeMemoryModel(params, {}).get()), nullptr);
}

TEST(MakeMemoryModel, RefusesAnUnknownNameAndBadParameters) {
  MemoryParams params;
  params.memory = "elephant";
  EXPECT_THAT([&] { makeMemoryModel(params, {}); },
              testing::ThrowsMessage<base::ConfigError>("memory: 'elephant' is not one of fsh | static"));
  FshParams fsh;
  fsh.max_features = 10;
  EXPECT_THAT([&] { makeMemoryModel({}, fsh); },
              testing::ThrowsMessage<base::ConfigError>(
                  "[fsh] ltm_min_features = 280 must not exceed max_features = 10"));
  fsh.max_features = 0;
  EXPECT_THAT([&] { makeMemoryModel({}, fsh); }, testing::ThrowsMessage<base::ConfigError>(
                                                     testing::HasSubstr("max_features: 0 is out of range")));
}

TEST(MemoryConfig, ReadsItsOwnDump) {
  MemoryParams memory;
  FshParams fsh;
  fsh.prune_view = 7;
  fsh.vote_variance = "literal";
  base::Config config;
  config.bind("memory", memory);
  config.bind("fsh", fsh);
  const auto text = config.dump();

  MemoryParams memory2;
  FshParams fsh2;
  base::Config config2;
  config2.bind("memory", memory2);
  config2.bind("fsh", fsh2);
  config2.read(base::IniFile::parse(text, "dump"));
  EXPECT_EQ(fsh2.prune_view, 7);
  EXPECT_EQ(fsh2.vote_variance, "literal");
  EXPECT_EQ(config2.dump(), text);
}

}  // namespace
}  // namespace engram::memory
