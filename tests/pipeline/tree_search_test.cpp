// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tree_search.h"

#include "engram/base/rng.h"
#include "engram/memory/static_view.h"
#include "engram/pipeline/scorer.h"

#include <gtest/gtest.h>

#include <algorithm>

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

TEST(TreeSearch, FindsEveryViewBeforeAndAfterItsTreeIsThere) {
  map::TopologicalMap map;
  TreeSearch search(params());
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

TEST(TreeSearch, ForgetsWhatTheMapForgets) {
  for (const int views : {8, 45}) {  // without and with a tree
    map::TopologicalMap map;
    TreeSearch search(params());
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

TEST(TreeSearch, AMapThatIsReadAnswersAsTheOneThatGrew) {
  map::TopologicalMap map;
  for (std::uint64_t k = 0; k < 8; ++k) addView(map, k);
  TreeSearch search(params());
  search.load(map);
  EXPECT_FALSE(search.hasTree());
  EXPECT_EQ(search.find(map.place(base::PlaceId(5)).memory->features).front().view.value, 5u);
}

TEST(TreeSearch, AnEmptyMapHasNoAnswer) { EXPECT_TRUE(TreeSearch(params()).find(randomView(1)).empty()); }

TEST(TreeScorer, FindsThePlacesOfAMapThatBeganEmpty) {
  PipelineParams p = params();
  p.recognise.scorer = "vocabulary_tree";
  const auto scorer = makeScorer(p);
  map::TopologicalMap map;
  for (std::uint64_t k = 0; k < 50; ++k) {  // without a tree until 30
    scorer->placeChanged(k, map.place(addView(map, k)));
    scorer->settled(map);
    for (std::uint64_t j = 0; j <= k; j += 7) {
      const auto scores = scorer->scores(randomView(j));
      ASSERT_EQ(scores.size(), k + 1);
      EXPECT_EQ(scores[j], 1.0) << j << " of " << k;
      EXPECT_EQ(std::max_element(scores.begin(), scores.end()) - scores.begin(), static_cast<long>(j));
    }
  }
}

/// Localising asks at once, and adds no place.
TEST(TreeScorer, ATreeOfTheLoadedPlacesIsThereAtOnce) {
  PipelineParams p = params();
  p.recognise.scorer = "vocabulary_tree";
  map::TopologicalMap map;
  std::vector<base::PlaceId> ids;
  for (std::uint64_t k = 0; k < 8; ++k) ids.push_back(addView(map, k));
  TreeSearch search(p, TreeSearch::Of::kPlaces);
  search.load(map);
  EXPECT_TRUE(search.hasTree());
  const auto scorer = makeScorer(p);
  scorer->load(map, ids);
  EXPECT_EQ(scorer->scores(randomView(5))[5], 1.0);
}

}  // namespace
}  // namespace engram::pipeline
