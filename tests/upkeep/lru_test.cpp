// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/upkeep/lru.h"

#include "engram/base/rng.h"
#include "engram/upkeep/clusters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>

namespace engram::upkeep::lru {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kInf = std::numeric_limits<double>::infinity();

PlaceId p(std::size_t v) { return PlaceId(static_cast<std::uint32_t>(v)); }

/// Views that match where their letters agree; stamps and ids count up unless given.
struct Scene {
  explicit Scene(const std::string& letters) : look(letters) {
    for (std::size_t i = 0; i < look.size(); ++i) views.push_back({p(i), 100.0 + static_cast<double>(i)});
  }
  Eigen::MatrixXd closeness() const {
    const auto n = static_cast<Eigen::Index>(look.size());
    Eigen::MatrixXd c(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j)
        c(i, j) = look[static_cast<std::size_t>(i)] == look[static_cast<std::size_t>(j)] ? 1 : kInf;
    return c;
  }
  /// The last letter is the new view.
  LruPlan plan(const LruRule& rule) const {
    return planDeletion(std::span(views).first(views.size() - 1), views.back(), closeness(), rule);
  }
  std::string look;
  std::vector<LruView> views;
};

std::string lettersOf(const Scene& scene, const LruPlan& plan) {
  std::string letters;
  for (const LruView& v : plan.kept) letters += scene.look[v.id.value];
  return letters;
}

std::vector<std::uint32_t> deletedOf(const LruPlan& plan) {
  std::vector<std::uint32_t> ids;
  for (const auto& d : plan.deleted) ids.push_back(d.id.value);
  return ids;
}

LruRule kappa(int n, bool probation = true) { return {.max_views = n, .probation = probation}; }

TEST(Lru, AddsUntilTheNeighbourhoodIsFull) {
  const auto plan = Scene("ABA").plan(kappa(3));
  EXPECT_EQ(plan.kept.size(), 3u);
  EXPECT_THAT(plan.deleted, IsEmpty());
  EXPECT_EQ(plan.kept[2].standing, Standing::kConfirmed);
}

TEST(Lru, ThinsTheOldestOfTheThickClustersFirst) {
  // B is the oldest of all, but single; of A and C, A has the oldest exemplar.
  const auto plan = Scene(
                        "BACAC"
                        "C")
                        .plan(kappa(5));
  EXPECT_THAT(plan.deleted, ElementsAre(LruDeletion{p(1), {p(3)}}));
  EXPECT_THAT(deletedOf(Scene("BACAC"
                              "C")
                            .plan(kappa(4))),
              ElementsAre(1u, 2u));
  EXPECT_THAT(deletedOf(Scene("BACAC"
                              "C")
                            .plan(kappa(3))),
              ElementsAre(1u, 2u, 4u));
  EXPECT_THAT(deletedOf(Scene("BACAC"
                              "C")
                            .plan(kappa(2))),
              ElementsAre(1u, 2u, 4u, 0u));
  EXPECT_THAT(deletedOf(Scene("BACAC"
                              "C")
                            .plan(kappa(1))),
              ElementsAre(1u, 2u, 4u, 0u, 3u));
}

TEST(Lru, AgeGoesByStampThenByNumber) {
  Scene scene("AAAA");
  scene.views[0].stamp = 500;
  scene.views[1].stamp = scene.views[2].stamp = 50;
  EXPECT_THAT(deletedOf(scene.plan(kappa(3))), ElementsAre(1u));
  scene.views[2].standing = Standing::kUnmatched;
  scene.look = "AABA";
  EXPECT_THAT(deletedOf(scene.plan(kappa(2))), ElementsAre(1u, 3u))
      << "thick clusters before unmatched views";
  EXPECT_THAT(deletedOf(scene.plan(kappa(1))), ElementsAre(1u, 3u, 2u));
}

TEST(Lru, UnmatchedViewsAreTheOldestUntilConfirmed) {
  Scene scene(
      "ABC"
      "A");
  scene.views[2].standing = Standing::kUnmatched;  // C, newer than B
  const auto plan = scene.plan(kappa(2));
  EXPECT_THAT(deletedOf(plan), ElementsAre(0u, 2u));
  Scene again(
      "ABC"
      "C");
  again.views[2].standing = Standing::kUnmatched;
  const auto confirmed = again.plan(kappa(4));
  EXPECT_EQ(confirmed.kept[2].standing, Standing::kConfirmed);
  EXPECT_EQ(confirmed.kept[2].stamp, 102);
  EXPECT_EQ(again.plan(kappa(4, false)).kept[2].standing, Standing::kUnmatched)
      << "stamp -1 stays, as printed";
}

/// K-E8: what the paper's code does where all clusters are single, and what its prose says.
TEST(Lru, FullNeighbourhoodTakesAnUnmatchedViewOnProbation) {
  EXPECT_THAT(Scene("ABC"
                    "D")
                  .plan(kappa(3, false))
                  .deleted,
              ElementsAre(LruDeletion{p(3), {}}));
  Scene scene(
      "ABC"
      "D");
  auto plan = scene.plan(kappa(3));
  EXPECT_THAT(plan.deleted, IsEmpty());
  EXPECT_EQ(plan.kept.back().standing, Standing::kProbation);
  // Also where other clusters could be thinned: a passer-by costs nothing (K-31).
  EXPECT_THAT(Scene("AAB"
                    "D")
                  .plan(kappa(3))
                  .deleted,
              IsEmpty());
  EXPECT_EQ(Scene("AA"
                  "D")
                .plan(kappa(3))
                .kept.back()
                .standing,
            Standing::kUnmatched)
      << "there is room";

  Scene next(
      "ABCD"
      "A");
  next.views[3].standing = Standing::kProbation;
  EXPECT_THAT(deletedOf(next.plan(kappa(3))), ElementsAre(3u, 0u));
  next.look =
      "ABCD"
      "D";
  plan = next.plan(kappa(3));
  EXPECT_THAT(plan.deleted, ElementsAre(LruDeletion{p(3), {p(4)}}, LruDeletion{p(0), {}}));
  EXPECT_EQ(lettersOf(next, plan), "BCD");
  next.look =
      "ABCD"
      "E";
  plan = next.plan(kappa(3));
  EXPECT_THAT(deletedOf(plan), ElementsAre(3u));
  EXPECT_EQ(plan.kept.back(), (LruView{p(4), 104, Standing::kProbation}));
}

TEST(Lru, TouchMakesMatchedViewsAsRecentAsTheNewOne) {
  LruRule rule = kappa(3);
  rule.touch_on_match = true;
  Scene scene(
      "ABC"
      "A");
  const auto plan = scene.plan(rule);  // both A are new now: the lower number goes
  EXPECT_THAT(deletedOf(plan), ElementsAre(0u));
  rule.max_views = 4;
  EXPECT_EQ(scene.plan(rule).kept[0].stamp, 103);
  scene.views[3].stamp = 7;  // from a drive of long ago
  EXPECT_EQ(scene.plan(rule).kept[0].stamp, 100);
}

TEST(Lru, RefusesWhatCannotBe) {
  const Scene scene("AB");
  EXPECT_THROW(scene.plan(kappa(0)), std::invalid_argument);
  EXPECT_THROW(planDeletion(scene.views, scene.views[0], scene.closeness(), kappa(3)), std::invalid_argument);
}

/// Random neighbourhoods, closeness without any structure.
struct RandomScene {
  explicit RandomScene(base::Rng& rng) {
    n = rng.below(12);
    closeness = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n) + 1, static_cast<Eigen::Index>(n) + 1);
    for (Eigen::Index i = 0; i < closeness.rows(); ++i)
      for (Eigen::Index j = 0; j < i; ++j)
        closeness(i, j) = closeness(j, i) = rng.uniform() < 0.2 ? rng.uniform(0, 9) : rng.uniform(9.001, 99);
    for (std::size_t i = 0; i <= n; ++i)
      views.push_back({p(3 * i), static_cast<double>(rng.below(8)),
                       i < n ? static_cast<Standing>(rng.below(3)) : Standing::kConfirmed});
    rule.max_views = 1 + static_cast<int>(rng.below(6));
    rule.probation = rng.below(2) == 0;
    rule.touch_on_match = rng.below(3) == 0;
  }
  LruPlan plan() const { return planDeletion(std::span(views).first(n), views.back(), closeness, rule); }

  std::size_t n;
  std::vector<LruView> views;
  Eigen::MatrixXd closeness;
  LruRule rule;
};

TEST(LruLaw, KeepsAtMostKappaAndOneOnProbation) {
  base::Rng rng(1);
  for (int round = 0; round < 3000; ++round) {
    const RandomScene scene(rng);
    const auto plan = scene.plan();
    std::set<PlaceId> ids;
    int counted = 0, onProbation = 0;
    for (const auto& v : plan.kept) {
      ids.insert(v.id);
      ++(v.standing == Standing::kProbation ? onProbation : counted);
    }
    for (const auto& d : plan.deleted) ids.insert(d.id);
    EXPECT_EQ(ids.size(), scene.n + 1) << "each view is kept or deleted, once";
    EXPECT_EQ(plan.kept.size() + plan.deleted.size(), scene.n + 1);
    EXPECT_LE(counted, scene.rule.max_views);
    EXPECT_LE(onProbation, scene.rule.probation ? 1 : 0);
    EXPECT_EQ(onProbation == 1, plan.kept.back().standing == Standing::kProbation);
    EXPECT_GE(plan.kept.size(), std::min<std::size_t>(1, scene.n));
  }
}

/// While there are at most kappa clusters each keeps its newest view; beyond, the newest of these are kept.
TEST(LruLaw, KeepsTheNewestViewOfEachCluster) {
  using Age = std::tuple<bool, double, PlaceId>;
  base::Rng rng(2);
  int full = 0;
  for (int round = 0; round < 3000; ++round) {
    RandomScene scene(rng);
    for (auto& v : scene.views) v.standing = Standing::kConfirmed;
    scene.rule.touch_on_match = false;
    const auto plan = scene.plan();
    const auto cluster = singleLinkage(scene.closeness, scene.rule.tau);
    std::map<std::size_t, Age> newest;
    for (std::size_t i = 0; i <= scene.n; ++i) {
      const bool isNew = i == scene.n;
      if (isNew && plan.kept.back().standing == Standing::kProbation) continue;
      const bool matched = !isNew || std::count(cluster.begin(), cluster.end(), cluster[i]) > 1;
      const Age age(matched, scene.views[i].stamp, scene.views[i].id);
      const auto [known, isFirst] = newest.try_emplace(cluster[i], age);
      if (!isFirst) known->second = std::max(known->second, age);
    }
    std::vector<Age> wanted;
    for (const auto& [c, age] : newest) wanted.push_back(age);
    std::sort(wanted.rbegin(), wanted.rend());
    const auto room = static_cast<std::size_t>(scene.rule.max_views);
    full += wanted.size() > room ? 1 : 0;
    wanted.resize(std::min(wanted.size(), room));
    for (const auto& [matched, stamp, id] : wanted)
      EXPECT_TRUE(
          std::any_of(plan.kept.begin(), plan.kept.end(), [id = id](const LruView& v) { return v.id == id; }))
          << "round " << round;
  }
  EXPECT_GT(full, 500);
}

TEST(LruLaw, TheOrderOfTheViewsDoesNotMatter) {
  base::Rng rng(3);
  for (int round = 0; round < 500; ++round) {
    const RandomScene scene(rng);
    RandomScene mixed = scene;
    std::vector<std::size_t> order(scene.n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = scene.n; i > 1; --i)
      std::swap(order[i - 1], order[rng.below(static_cast<std::uint32_t>(i))]);
    order.push_back(scene.n);
    for (std::size_t i = 0; i <= scene.n; ++i) {
      mixed.views[i] = scene.views[order[i]];
      for (std::size_t j = 0; j <= scene.n; ++j)
        mixed.closeness(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            scene.closeness(static_cast<Eigen::Index>(order[i]), static_cast<Eigen::Index>(order[j]));
    }
    auto a = scene.plan(), b = mixed.plan();
    const auto byId = [](const auto& x, const auto& y) { return x.id < y.id; };
    for (auto* plan : {&a, &b}) {
      std::sort(plan->kept.begin(), plan->kept.end(), byId);
      // Probations end in the order given; all else is in the order of age.
      std::sort(plan->deleted.begin(), plan->deleted.end(), byId);
    }
    EXPECT_EQ(a.kept, b.kept);
    ASSERT_EQ(a.deleted.size(), b.deleted.size());
    for (std::size_t i = 0; i < a.deleted.size(); ++i) EXPECT_EQ(a.deleted[i].id, b.deleted[i].id);
  }
}

}  // namespace
}  // namespace engram::upkeep::lru
