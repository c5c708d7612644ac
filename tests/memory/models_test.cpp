// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/memory/models.h"

#include "engram/base/config.h"
#include "engram/base/error.h"
#include "engram/memory/static_view.h"
#include "replace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace engram::memory {
namespace {

TEST(MakeMemoryModel, ChoosesByName) {
  MemoryParams params;
  EXPECT_NE(dynamic_cast<Fsh*>(makeMemoryModel(params, {}, {}).get()), nullptr);
  params.memory = "static";
  EXPECT_NE(dynamic_cast<Static*>(makeMemoryModel(params, {}, {}).get()), nullptr);
  params.memory = "replace";
  EXPECT_NE(dynamic_cast<Replace*>(makeMemoryModel(params, {}, {}).get()), nullptr);
  params.memory = "multi_store";
  MultiStoreParams multiStore;
  multiStore.stm_states = 5;
  const auto model = makeMemoryModel(params, {}, multiStore);
  const auto* chosen = dynamic_cast<MultiStore*>(model.get());
  ASSERT_NE(chosen, nullptr);
  EXPECT_EQ(chosen->params().stm_states, 5);
}

TEST(MakeMemoryModel, RefusesAnUnknownNameAndBadParameters) {
  MemoryParams params;
  params.memory = "elephant";
  EXPECT_THAT([&] { makeMemoryModel(params, {}, {}); },
              testing::ThrowsMessage<base::ConfigError>(
                  "memory: 'elephant' is not one of fsh | multi_store | static | replace"));
  FshParams fsh;
  fsh.max_features = 10;
  EXPECT_THAT([&] { makeMemoryModel({}, fsh, {}); },
              testing::ThrowsMessage<base::ConfigError>(
                  "[fsh] ltm_min_features = 280 must not exceed max_features = 10"));
  fsh.max_features = 0;
  EXPECT_THAT(
      [&] { makeMemoryModel({}, fsh, {}); },
      testing::ThrowsMessage<base::ConfigError>(testing::HasSubstr("max_features: 0 is out of range")));
  params.memory = "multi_store";
  MultiStoreParams multiStore;
  multiStore.ltm_states = 0;
  EXPECT_THAT([&] { makeMemoryModel(params, {}, multiStore); },
              testing::ThrowsMessage<base::ConfigError>(testing::HasSubstr("ltm_states: 0 is out of range")));
  params = {};
  params.update_policy = "never";
  EXPECT_THAT(
      [&] { makeMemoryModel(params, {}, {}); },
      testing::ThrowsMessage<base::ConfigError>("update_policy: 'never' is not one of per_image | per_pass"));
}

TEST(MemoryConfig, ReadsItsOwnDump) {
  MemoryParams memory;
  FshParams fsh;
  MultiStoreParams multiStore;
  memory.update_policy = "per_pass";
  fsh.prune_view = 7;
  fsh.vote_variance = "literal";
  multiStore.stm_states = 4;
  multiStore.ltm_states = 5;
  const auto bind = [](base::Config& config, MemoryParams& m, FshParams& f, MultiStoreParams& s) {
    config.bind("memory", m);
    config.bind("fsh", f);
    config.bind("multi_store", s);
  };
  base::Config config;
  bind(config, memory, fsh, multiStore);
  const auto text = config.dump();

  MemoryParams memory2;
  FshParams fsh2;
  MultiStoreParams multiStore2;
  base::Config config2;
  bind(config2, memory2, fsh2, multiStore2);
  config2.read(base::IniFile::parse(text, "dump"));
  EXPECT_EQ(memory2.update_policy, "per_pass");
  EXPECT_EQ(fsh2.prune_view, 7);
  EXPECT_EQ(fsh2.vote_variance, "literal");
  EXPECT_EQ(multiStore2.stm_states, 4);
  EXPECT_EQ(multiStore2.ltm_states, 5);
  EXPECT_EQ(config2.dump(), text);
}

}  // namespace
}  // namespace engram::memory
