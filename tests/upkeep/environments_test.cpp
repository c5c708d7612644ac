// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// The environment classes of K-32 (Fig. 4 of the paper): one camera at one spot, for a long time.
#include "engram/base/rng.h"
#include "engram/upkeep/clusters.h"
#include "engram/upkeep/lru.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <string>
#include <vector>

namespace engram::upkeep {
namespace {

using ::testing::ElementsAre;

constexpr std::uint32_t kFeatures = 300;

/// What can be seen: numbered features. A view finds each of them with a chance of 0.8; those that two views
/// have in common are the inliers of their match.
class Spot {
 public:
  Spot(int kappa, std::uint64_t seed, bool probation = true) : rng_(seed) {
    rule_.max_views = kappa;
    rule_.tau = closeness(kFeatures, 30);
    rule_.probation = probation;
  }

  using Scenery = std::vector<std::uint32_t>;
  Scenery fresh() {
    Scenery s(kFeatures);
    std::iota(s.begin(), s.end(), next_);
    next_ += kFeatures;
    return s;
  }
  /// Replaces feature after feature in this range.
  void change(Scenery& s, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) s[i] = next_++;
  }

  /// Takes a picture and lets the rule decide.
  void see(const Scenery& scenery, char letter) {
    View view{LruView{PlaceId(static_cast<std::uint32_t>(letters_.size())), time_++}, {}};
    for (const auto f : scenery)
      if (rng_.uniform() < 0.8) view.features.insert(f);
    letters_ += letter;
    views_.push_back(view);
    const auto n = static_cast<Eigen::Index>(views_.size());
    Eigen::MatrixXd c = Eigen::MatrixXd::Zero(n, n);
    std::vector<LruView> before;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (i + 1 < n) before.push_back(views_[static_cast<std::size_t>(i)].lru);
      for (Eigen::Index j = 0; j < i; ++j)
        c(i, j) = c(j, i) = between(views_[static_cast<std::size_t>(i)], views_[static_cast<std::size_t>(j)]);
    }
    const LruPlan plan = planDeletion(before, view.lru, c, rule_);
    std::vector<View> kept;
    for (const LruView& k : plan.kept)
      for (View& v : views_)
        if (v.lru.id == k.id) kept.push_back({k, v.features});
    views_ = kept;
    EXPECT_LE(views_.size(), static_cast<std::size_t>(rule_.max_views) + (rule_.probation ? 1 : 0));
  }

  /// Letters of the views that are kept, oldest first.
  std::string kept() const {
    std::string s;
    for (const View& v : views_) s += letters_[v.lru.id.value];
    return s;
  }
  std::vector<std::uint32_t> ids() const {
    std::vector<std::uint32_t> ids;
    for (const View& v : views_) ids.push_back(v.lru.id.value);
    return ids;
  }
  std::size_t clusters() const {
    const auto n = static_cast<Eigen::Index>(views_.size());
    Eigen::MatrixXd c = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j)
        c(i, j) = between(views_[static_cast<std::size_t>(i)], views_[static_cast<std::size_t>(j)]);
    const auto labels = singleLinkage(c, rule_.tau);
    return std::set(labels.begin(), labels.end()).size();
  }
  /// Would a picture of this be recognised? A new view is held against all (K-33).
  bool recognises(const Scenery& scenery) const {
    const std::set<std::uint32_t> all(scenery.begin(), scenery.end());
    return std::any_of(views_.begin(), views_.end(), [&](const View& v) {
      return between(v, {{}, all}) <= rule_.tau;
    });
  }
  base::Rng& rng() { return rng_; }

 private:
  struct View {
    LruView lru;
    std::set<std::uint32_t> features;
  };
  static double between(const View& a, const View& b) {
    std::vector<std::uint32_t> common;
    std::set_intersection(a.features.begin(), a.features.end(), b.features.begin(), b.features.end(),
                          std::back_inserter(common));
    return closeness(static_cast<int>(std::min(a.features.size(), b.features.size())),
                     static_cast<int>(common.size()));
  }

  base::Rng rng_;
  LruRule rule_;
  std::uint32_t next_ = 0;
  double time_ = 0;
  std::string letters_;
  std::vector<View> views_;
};

TEST(Environments, StaticIsOneClusterOfTheNewestViews) {
  Spot spot(4, 1);
  const auto a = spot.fresh();
  for (int i = 0; i < 30; ++i) spot.see(a, 'A');
  EXPECT_THAT(spot.ids(), ElementsAre(26u, 27u, 28u, 29u));
  EXPECT_EQ(spot.clusters(), 1u);
}

/// Chairs and dishes come and go, two thirds stay.
TEST(Environments, SmallChangesAreOneClusterOfTheNewestViews) {
  Spot spot(4, 2);
  auto a = spot.fresh();
  for (int i = 0; i < 60; ++i) {
    const std::size_t at = 5 * static_cast<std::size_t>(i % 20);
    spot.change(a, at, at + 5);
    spot.see(a, 'A');
  }
  EXPECT_THAT(spot.ids(), ElementsAre(56u, 57u, 58u, 59u));
  EXPECT_EQ(spot.clusters(), 1u);
}

/// The new cluster grows to have all exemplars but one; that one remembers the past. Should the past come
/// back, it grows again.
TEST(Environments, AbruptChangeKeepsOneOfThePast) {
  Spot spot(4, 3);
  const auto a = spot.fresh(), d = spot.fresh();
  for (int i = 0; i < 20; ++i) spot.see(a, 'A');
  spot.see(d, 'D');
  EXPECT_EQ(spot.kept(), "AAAAD") << "on probation";
  for (int i = 0; i < 20; ++i) spot.see(d, 'D');
  EXPECT_EQ(spot.kept(), "ADDD");
  EXPECT_EQ(spot.ids().front(), 19u) << "the newest of the past";
  EXPECT_TRUE(spot.recognises(a));
  for (int i = 0; i < 20; ++i) spot.see(a, 'A');
  EXPECT_EQ(spot.kept(), "DAAA");
}

TEST(Environments, DoorOpenAndClosedAreBothKept) {
  Spot spot(4, 4);
  const auto open = spot.fresh(), closed = spot.fresh();
  for (int i = 0; i < 60; ++i) {
    const bool isOpen = spot.rng().uniform() < 0.7;
    spot.see(isOpen ? open : closed, isOpen ? 'o' : 'c');
    if (i > 10) {
      EXPECT_TRUE(spot.recognises(open) && spot.recognises(closed)) << i;
      EXPECT_EQ(spot.clusters(), 2u);
    }
  }
}

/// Someone stands before the camera, now and then, never the same.
TEST(Environments, EphemeralViewsGoWithTheNextOne) {
  for (const bool literal : {false, true}) {
    Spot spot(3, 5, !literal);
    const auto a = spot.fresh();
    for (int i = 0; i < 10; ++i) spot.see(a, 'A');
    int passed = 0;
    for (int i = 0; i < 50; ++i) {
      const bool hidden = spot.rng().uniform() < 0.3;
      spot.see(hidden ? spot.fresh() : a, hidden ? 'e' : 'A');
      passed += hidden ? 1 : 0;
      EXPECT_TRUE(spot.recognises(a)) << i;
      if (!literal) {
        EXPECT_EQ(spot.kept(), hidden ? "AAAe" : "AAA") << i;
      }
    }
    spot.see(a, 'A');
    EXPECT_GT(passed, 8);
    // As printed, each of them takes the room of an exemplar of A, and none is dropped before A has but one.
    EXPECT_EQ(spot.kept(), literal ? "eeA" : "AAA");
  }
}

/// K-E8, the numbers of the requirement: three environments that were all seen again fill the neighbourhood,
/// then the room is changed for good.
TEST(Environments, SaturatedNeighbourhoodLearnsOnlyWithProbation) {
  for (const bool probation : {false, true}) {
    Spot spot(3, 6, probation);
    for (const char letter : {'A', 'B', 'C'}) {
      const auto scenery = spot.fresh();
      for (int i = 0; i < 2; ++i) spot.see(scenery, letter);
    }
    ASSERT_EQ(spot.kept(), "ABC");
    const auto d = spot.fresh();
    for (int i = 0; i < 50; ++i) spot.see(d, 'D');
    EXPECT_EQ(spot.kept(), probation ? "BCD" : "ABC");
    EXPECT_EQ(spot.recognises(d), probation);
  }
}

/// All at once: small changes, a door, passers-by, and a change for good in the middle.
TEST(Environments, MixtureKnowsWhatItMayMeetAgain) {
  Spot spot(6, 7);
  auto open = spot.fresh(), closed = spot.fresh();
  for (int i = 0; i < 200; ++i) {
    if (i == 100) open = spot.fresh();
    const std::size_t at = 5 * static_cast<std::size_t>(i % 20);
    spot.change(open, at, at + 5);
    spot.change(closed, at, at + 5);
    const double chance = spot.rng().uniform();
    if (chance < 0.15)
      spot.see(spot.fresh(), 'e');
    else
      spot.see(chance < 0.6 ? open : closed, chance < 0.6 ? (i < 100 ? 'o' : 'O') : 'c');
    if (i < 20 || (i >= 100 && i < 110)) continue;
    EXPECT_TRUE(spot.recognises(open) && spot.recognises(closed)) << i;
  }
  EXPECT_THAT(spot.kept(), ::testing::Not(::testing::HasSubstr("e")));
}

/// K-30: environments that last for some views each, more of them than there is room for.
TEST(Environments, EquilibriumIsTheNewestViewOfTheLatestEnvironments) {
  constexpr std::size_t kRoom = 4;
  Spot spot(kRoom, 8);
  std::vector<Spot::Scenery> rooms;
  for (int r = 0; r < 7; ++r) rooms.push_back(spot.fresh());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> lastView;  // view, room; oldest first
  std::uint32_t view = 0;
  for (int block = 0; block < 60; ++block) {
    const auto room = spot.rng().below(7);
    const auto length = 2 + spot.rng().below(5);
    for (std::uint32_t i = 0; i < length; ++i, ++view) spot.see(rooms[room], 'R');
    std::erase_if(lastView, [&](const auto& seen) { return seen.second == room; });
    lastView.emplace_back(view - 1, room);
    if (lastView.size() < 7) continue;
    std::vector<std::uint32_t> expected;
    for (auto it = lastView.end() - kRoom; it != lastView.end(); ++it) expected.push_back(it->first);
    EXPECT_EQ(spot.ids(), expected) << block;
  }
}

}  // namespace
}  // namespace engram::upkeep
