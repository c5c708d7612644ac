// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/params.h"

#include "engram/base/error.h"
#include "engram/base/ids.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <unordered_set>

namespace engram::base {
namespace {

using testing::ThrowsMessage;

struct Sample {
  double ratio = 0.5;
  std::string kind = "a";
  void describe(Params& p) {
    p.add("ratio", ratio, "of this to that", {0, 1});
    p.addChoice("kind", kind, "which", {"a", "b"});
  }
};

TEST(Validate, NamesKeyValueAndBound) {
  Sample sample;
  EXPECT_NO_THROW(validate(sample));
  sample.ratio = 2;
  EXPECT_THAT([&] { validate(sample); },
              ThrowsMessage<ConfigError>("ratio: 2 is out of range: must be in [0, 1]"));
  sample.ratio = NAN;
  EXPECT_THROW(validate(sample), ConfigError);
  sample.ratio = 1;
  sample.kind = "c";
  EXPECT_THAT([&] { validate(sample); }, ThrowsMessage<ConfigError>("kind: 'c' is not one of a | b"));
}

TEST(Validate, DoesNotChangeTheStruct) {
  const Sample sample{0.25, "b"};
  validate(sample);
  EXPECT_EQ(sample.ratio, 0.25);
  EXPECT_EQ(sample.kind, "b");
}

TEST(Errors, OfTheConfigurationAreErrors) {
  EXPECT_THROW(throw ConfigError("x"), Error);
  EXPECT_THROW(throw Error("x"), std::runtime_error);
}

TEST(StrongId, IsInvalidUntilSetOrderedAndHashed) {
  EXPECT_FALSE(PlaceId().valid());
  EXPECT_TRUE(PlaceId(0).valid());
  EXPECT_LT(PlaceId(3), PlaceId(4));
  EXPECT_EQ(PlaceId(3), PlaceId(3));
  EXPECT_LT(PlaceId(3), PlaceId()) << "invalid ids sort last";
  const std::unordered_set<PlaceId> set{PlaceId(1), PlaceId(2), PlaceId(1)};
  EXPECT_EQ(set.size(), 2u);
  static_assert(!std::is_convertible_v<PlaceId, ViewId> && !std::is_convertible_v<std::uint32_t, PlaceId>);
}

}  // namespace
}  // namespace engram::base
