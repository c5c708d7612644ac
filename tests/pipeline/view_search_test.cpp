// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "view_search.h"

#include "engram/base/rng.h"
#include "engram/memory/static_view.h"

#include <gtest/gtest.h>

namespace engram::pipeline {
namespace {

/// A view of 60 random features.
types::Features randomView(std::uint64_t seed) {
  base::Rng rng(seed);
  types::Features view;
  view.descriptors = types::Descriptors(types::DescriptorKind::kFloat, 64);
  for (int i = 0; i < 60; ++i) {
    Eigen::Matrix<float, 64, 1> d;
    for (int k = 0; k < 64; ++k) d[k] = static_cast<float>(rng.normal());
    d.normalize();
    view.descriptors.append(std::as_bytes(std::span<const float>(d.data(), 64)));
    view.keypoints.push_back({static_cast<float>(i), 0, 5, 0, 1, 1});
  }
  return view;
}

base::PlaceId addView(map::TopologicalMap& map, std::uint64_t seed) {
  map::Place place;
  place.memory = memory::Static().start(randomView(seed));
  return map.addPlace(std::move(place));
}

PipelineParams params() {
  PipelineParams p;
  p.views.train_after = 10;
  p.views.candidates = 5;
  return p;
}

TEST(ViewSearch, FindsEveryViewBeforeAndAfterItsTreeIsThere) {
  map::TopologicalMap map;
  ViewSearch search(params());
  for (std::uint64_t k = 0; k < 50; ++k) {
    addView(map, k);
    search.follow(map);
    EXPECT_EQ(search.hasTree(), k >= 29) << "trained from 10 on, in use 20 views later: " << k;
    for (std::uint64_t j = 0; j <= k; j += 7) {
      const auto found = search.find(
          types::Features(map.place(base::PlaceId(static_cast<std::uint32_t>(j))).memory->features));
      ASSERT_FALSE(found.empty());
      EXPECT_EQ(found.front().view.value, j);
      EXPECT_LE(found.size(), 5u);
    }
  }
}

TEST(ViewSearch, ForgetsWhatTheMapForgets) {
  for (const int views : {8, 45}) {  // without and with a tree
    map::TopologicalMap map;
    ViewSearch search(params());
    for (int k = 0; k < views; ++k) {
      addView(map, static_cast<std::uint64_t>(k));
      search.follow(map);
    }
    const base::PlaceId gone(3);
    const types::Features image = map.place(gone).memory->features;
    map.removePlace(gone, base::PlaceId(4));
    search.follow(map);
    for (const auto& found : search.find(image)) EXPECT_NE(found.view, gone);
  }
}

TEST(ViewSearch, AMapThatIsReadAnswersAsTheOneThatGrew) {
  map::TopologicalMap map;
  for (std::uint64_t k = 0; k < 8; ++k) addView(map, k);
  ViewSearch search(params());
  search.load(map);
  EXPECT_FALSE(search.hasTree());
  EXPECT_EQ(search.find(map.place(base::PlaceId(5)).memory->features).front().view.value, 5u);
}

TEST(ViewSearch, AnEmptyMapHasNoAnswer) { EXPECT_TRUE(ViewSearch(params()).find(randomView(1)).empty()); }

}  // namespace
}  // namespace engram::pipeline
