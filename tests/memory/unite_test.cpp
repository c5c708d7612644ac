// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/memory/unite.h"

#include "make_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace engram::memory {
namespace {

/// A memory that has seen n features, each by its own descriptor; feature i has value `value`.
PlaceMemory seen(const MemoryModel& model, const types::Features& all, int from, int to) {
  std::vector<int> indices;
  for (int i = from; i < to; ++i) indices.push_back(i);
  return model.start(all.subset(indices));
}

/// Feature i of a with feature i - shift of b.
std::vector<types::Match> overlap(int from, int to, int shift) {
  std::vector<types::Match> matches;
  for (int i = from; i < to; ++i) matches.push_back({i - shift, i, 0});
  return matches;
}

std::vector<float> values(const PlaceMemory& m) {
  std::vector<float> all;
  for (const auto& s : m.states) all.push_back(s.value);
  std::sort(all.begin(), all.end());
  return all;
}

types::Features thirty() {
  std::vector<int> identities;
  std::vector<float> responses;
  for (int i = 0; i < 30; ++i) {
    identities.push_back(i);
    responses.push_back(0.1f + 0.03f * static_cast<float>(i));
  }
  return makeFeatures(identities, responses);
}

class Unite : public ::testing::Test {
 protected:
  Unite() { fsh.ltm_min_features = 1; }
  United united(const PlaceMemory& a, const PlaceMemory& b, const std::vector<types::Match>& matches) const {
    return unite(a, b, matches, params, fsh, multiStore);
  }
  MemoryParams params;
  FshParams fsh;
  MultiStoreParams multiStore;
  types::Features all = thirty();
};

TEST_F(Unite, FshVotesAddUpWhicheverComesFirst) {
  const Fsh model(fsh);
  const PlaceMemory a = seen(model, all, 0, 20), b = seen(model, all, 10, 30);
  const United ab = united(a, b, overlap(10, 20, 10));
  EXPECT_EQ(ab.memory.states.size(), 30u);
  EXPECT_EQ(ab.memory.updates, 2u);
  for (int i = 10; i < 20; ++i) {
    const auto& both = ab.memory.states[static_cast<std::size_t>(i)];
    EXPECT_FLOAT_EQ(both.value, a.states[static_cast<std::size_t>(i)].value +
                                    b.states[static_cast<std::size_t>(i - 10)].value);
    EXPECT_EQ(both.counter, 1);
    EXPECT_EQ(ab.idOfB.at(static_cast<std::uint32_t>(i - 10)), both.id);
  }
  std::vector<types::Match> back = overlap(10, 20, 10);
  for (auto& m : back) std::swap(m.a, m.b);
  const United ba = united(b, a, back);
  EXPECT_EQ(values(ab.memory), values(ba.memory));
  EXPECT_EQ(ab.memory.longTerm().size(), ba.memory.longTerm().size());
}

TEST_F(Unite, FshGroupingDoesNotMatter) {
  const Fsh model(fsh);
  const PlaceMemory a = seen(model, all, 0, 12), b = seen(model, all, 6, 20), c = seen(model, all, 6, 12);
  const auto ab = united(a, b, overlap(6, 12, 6)).memory;
  const auto left = united(ab, c, overlap(6, 12, 6)).memory;  // features 6 to 11 of ab are those of c
  const auto bc = united(b, c, overlap(0, 6, 0)).memory;
  const auto right = united(a, bc, overlap(6, 12, 6)).memory;
  ASSERT_EQ(left.states.size(), right.states.size());
  for (std::size_t i = 0; i < left.states.size(); ++i) EXPECT_FLOAT_EQ(values(left)[i], values(right)[i]);
  EXPECT_EQ(left.updates, 3u);
}

TEST_F(Unite, TheCapHoldsAndNumbersLeadToWhatStayed) {
  fsh.max_features = 15;
  const Fsh model(fsh);
  const United u = united(seen(model, all, 0, 12), seen(model, all, 12, 24), {});
  EXPECT_EQ(u.memory.states.size(), 15u);
  EXPECT_EQ(u.idOfA.size() + u.idOfB.size(), 15u);
}

TEST_F(Unite, NothingIsForgottenThatOneSideAloneHas) {
  const Fsh model(fsh);
  const PlaceMemory a = seen(model, all, 0, 10), b = seen(model, all, 10, 20);
  EXPECT_EQ(united(a, b, {}).memory.states.size(), 20u);
}

TEST_F(Unite, StagesOfTheMultiStore) {
  params.memory = "multi_store";
  const MultiStore model(multiStore);
  PlaceMemory a = seen(model, all, 0, 4), b = seen(model, all, 0, 4);
  a.states[0].counter = 5;  // both long-term: the fewer misses
  b.states[0].counter = 2;
  a.states[1].stage = Stage::kShortTerm;  // one long-term: it stays so
  b.states[1].counter = 3;
  for (PlaceMemory* m : {&a, &b}) {
    m->states[2].stage = m->states[3].stage = Stage::kShortTerm;
    m->states[2].counter = m->states[3].counter = 1;
  }
  b.states[3].counter = 2;  // 1 + 2 sightings: one more than a short-term feature has states
  const auto u = united(a, b, overlap(0, 4, 0)).memory;
  EXPECT_EQ(u.states[0].counter, 2);
  EXPECT_EQ(u.states[1].stage, Stage::kLongTerm);
  EXPECT_EQ(u.states[1].counter, 3);
  EXPECT_EQ(u.states[2].stage, Stage::kShortTerm);
  EXPECT_EQ(u.states[2].counter, 2);
  EXPECT_EQ(u.states[3].stage, Stage::kLongTerm);
  EXPECT_EQ(u.states[3].counter, 1);
  EXPECT_FLOAT_EQ(u.states[0].value, 2);
}

TEST_F(Unite, StaticKeepsTheOlderAndReplaceTheNewer) {
  const Fsh model(fsh);
  const PlaceMemory a = seen(model, all, 0, 5), b = seen(model, all, 5, 12);
  params.memory = "static";
  EXPECT_EQ(united(a, b, {}).memory.states, a.states);
  EXPECT_TRUE(united(a, b, {}).idOfB.empty());
  params.memory = "replace";
  EXPECT_EQ(united(a, b, {}).memory.states, b.states);
}

TEST_F(Unite, MatchesMustBeOneToOne) {
  const Fsh model(fsh);
  const PlaceMemory a = seen(model, all, 0, 5);
  const std::vector<types::Match> twice = {{0, 1, 0}, {2, 1, 0}};
  EXPECT_THROW(united(a, a, twice), std::invalid_argument);
}

TEST_F(Unite, CountsOfTwoMapsAddUp) {
  Redetections a, b;
  a.views = 3;
  b.views = 4;
  a.byValue[5] = {10, 4};
  b.byValue[5] = {7, 7};
  b.byAge[1] = {2, 1};
  const Redetections s = sum(a, b);
  EXPECT_EQ(s.views, 7u);
  EXPECT_EQ(s.byValue[5], (Redetections::Count{17, 11}));
  EXPECT_EQ(s, sum(b, a));
}

}  // namespace
}  // namespace engram::memory
