// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Two laps of a square by odometry that drifts: what enters, what is refused, what leaves again.
#include "engram/pipeline/closure_book.h"

#include "../map/sample_map.h"
#include "engram/base/rng.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace engram::pipeline {
namespace {

using engram::testing::planarPose;
using posegraph::ClosureReason;

constexpr std::uint32_t kLap = 80;  // places, one metre apart

base::PlaceId p(std::uint32_t v) { return base::PlaceId(v); }

types::RelPose measured(const Eigen::Isometry3d& T_a_b, double sigma, double sigmaYaw) {
  types::RelPose m;
  m.T_a_b = T_a_b;
  m.cov.setZero();
  m.cov.diagonal() << sigma * sigma, sigma * sigma, 1e-4, 1e-4, 1e-4, sigmaYaw * sigmaYaw;
  return m;
}

class Laps : public ::testing::Test {
 protected:
  Laps() {
    for (std::uint32_t i = 0; i < 2 * kLap; ++i) truth_.push_back(onSquare(i % kLap));
    addChain(0, 2 * kLap, Eigen::Isometry3d::Identity());
  }

  static Eigen::Isometry3d onSquare(std::uint32_t i) {
    const int side = static_cast<int>(i) / 20;
    const double along = i % 20;
    const Eigen::Isometry3d corners[] = {planarPose(0, 0, 0), planarPose(20, 0, M_PI / 2),
                                         planarPose(20, 20, M_PI), planarPose(0, 20, -M_PI / 2)};
    return corners[side] * planarPose(along, 0, 0);
  }

  /// Places [from, to) joined by odometry; the first of them lies at `start` in the map.
  void addChain(std::uint32_t from, std::uint32_t to, const Eigen::Isometry3d& start) {
    Eigen::Isometry3d T = start;
    for (std::uint32_t i = from; i < to; ++i) {
      Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
      if (i > from) {
        step = truth_[i - 1].inverse() * truth_[i] *
               planarPose(0.02 * rng_.normal(), 0.01 * rng_.normal(), 0.008 * rng_.normal());
        T = T * step;
      }
      map::Place place;
      place.T_map_place = T;
      place.memory = engram::testing::randomMemory(rng_, 4, 1);
      map_.addPlace(std::move(place));
      if (i > from)
        map_.addEdge({.type = map::EdgeType::kOdometry,
                      .a = p(i - 1),
                      .b = p(i),
                      .T_a_b = measured(step, 0.025, 0.01),
                      .correspondences = {}});
    }
  }

  map::Edge closure(std::uint32_t a, std::uint32_t b) {
    const Eigen::Isometry3d T = planarPose(0.1 * rng_.normal(), 0.1 * rng_.normal(), 0.02 * rng_.normal());
    return {.type = map::EdgeType::kLoop,
            .a = p(a),
            .b = p(b),
            .T_a_b = measured(T, 0.2, 0.03),
            .correspondences = {}};
  }

  /// Root mean square distance between the places of the first half of a lap and those of the second lap,
  /// which are the same in truth [m]. The closures of these tests are there.
  double error() const {
    double sum = 0;
    for (std::uint32_t i = 0; i < kLap / 2; ++i)
      sum += (map_.place(p(i)).T_map_place.translation() - map_.place(p(kLap + i)).T_map_place.translation())
                 .squaredNorm();
    return std::sqrt(sum / (kLap / 2));
  }

  std::size_t loops() const {
    std::size_t n = 0;
    for (const auto& [id, edge] : map_.edges()) n += edge.type == map::EdgeType::kLoop;
    return n;
  }

  base::Rng rng_{4};
  std::vector<Eigen::Isometry3d> truth_;
  map::TopologicalMap map_;
  ClosureBook book_{posegraph::RelaxerParams{}};
};

TEST_F(Laps, TrueClosuresEnterAndStraightenTheMap) {
  const double before = error();
  int refused = 0, restored = 0;
  for (std::uint32_t i = 0; i < 40; i += 2) {
    const auto decision = book_.propose(map_, closure(kLap + i, i));
    const auto changes = book_.apply(map_);
    EXPECT_EQ(decision.accepted, changes.proposed.valid());
    EXPECT_TRUE(changes.dropped.empty());
    refused += !decision.accepted;
    restored += changes.restored;
  }
  EXPECT_EQ(loops(), 20u);
  EXPECT_EQ(refused, restored) << "one that had to wait for others comes in with them";
  EXPECT_GT(before, 0.5);
  EXPECT_LT(error(), 0.15);
  map_.checkInvariants();
}

TEST_F(Laps, ALieIsRefusedAndChangesNothing) {
  for (std::uint32_t i = 0; i < 40; i += 2) {
    book_.propose(map_, closure(kLap + i, i));
    book_.apply(map_);
  }
  const double before = error();
  for (const auto& [a, b] : {std::pair{130u, 10u}, {140u, 20u}, {100u, 60u}}) {
    EXPECT_FALSE(book_.propose(map_, closure(a, b)).accepted) << a << " is not " << b;
    const auto changes = book_.apply(map_);
    EXPECT_FALSE(changes.proposed.valid());
    EXPECT_TRUE(changes.dropped.empty());
  }
  EXPECT_EQ(loops(), 20u);
  EXPECT_NEAR(error(), before, 0.01);
}

TEST_F(Laps, CountsWhatJoinsTwoPlacesRefusedOrNot) {
  EXPECT_EQ(book_.count(p(130), p(10)), 0);
  book_.propose(map_, closure(130, 10));
  book_.apply(map_);
  book_.propose(map_, closure(10, 130));
  book_.apply(map_);
  EXPECT_EQ(book_.count(p(130), p(10)), 2);
  EXPECT_EQ(book_.count(p(10), p(130)), 2);
  EXPECT_EQ(book_.count(p(130), p(11)), 0);
}

TEST_F(Laps, ALieThatIsInTheMapIsDeniedByTheTruth) {
  map::Edge lie = closure(kLap + 10, 30);
  lie.id = map_.addEdge(lie);
  book_.enter(lie);
  bool dropped = false;
  for (std::uint32_t i = 0; i < 40; i += 2) {
    book_.propose(map_, closure(kLap + i, i));
    const auto changes = book_.apply(map_);
    dropped = dropped || std::count(changes.dropped.begin(), changes.dropped.end(), lie.id) > 0;
  }
  EXPECT_TRUE(dropped);
  EXPECT_FALSE(map_.edges().contains(lie.id));
  EXPECT_EQ(loops(), 20u);
}

TEST_F(Laps, AClosureThatJoinsTwoPartsMovesTheLaterOne) {
  truth_.resize(3 * kLap);
  for (std::uint32_t i = 2 * kLap; i < 3 * kLap; ++i) truth_[i] = onSquare(i % kLap);
  addChain(2 * kLap, 3 * kLap, planarPose(7, -30, 2.0));
  const map::Edge edge = closure(2 * kLap + 5, 5);
  EXPECT_TRUE(book_.propose(map_, edge).accepted);
  EXPECT_TRUE(book_.apply(map_).proposed.valid());
  const Eigen::Isometry3d T_map_b = map_.place(edge.a).T_map_place * edge.T_a_b.T_a_b;
  EXPECT_TRUE(T_map_b.isApprox(map_.place(edge.b).T_map_place, 1e-3));
  EXPECT_TRUE(map_.place(p(0)).T_map_place.isApprox(planarPose(0, 0, 0), 1e-9)) << "the first part stays";
}

TEST_F(Laps, AWeakEdgeDeniesNothing) {
  truth_.resize(3 * kLap);
  for (std::uint32_t i = 2 * kLap; i < 3 * kLap; ++i) truth_[i] = onSquare(i % kLap);
  addChain(2 * kLap, 3 * kLap, map_.place(p(2 * kLap - 1)).T_map_place);
  map_.addEdge({.type = map::EdgeType::kWeak,
                .a = p(2 * kLap - 1),
                .b = p(2 * kLap),
                .T_a_b = measured(Eigen::Isometry3d::Identity(), 0.8, 1.0),
                .correspondences = {}});
  EXPECT_TRUE(book_.propose(map_, closure(2 * kLap + 40, 40)).accepted);
}

TEST_F(Laps, AMapThatIsLoadedKeepsItsClosures) {
  for (std::uint32_t i = 0; i < 40; i += 2) {
    book_.propose(map_, closure(kLap + i, i));
    book_.apply(map_);
  }
  const auto edges = map_.edges().size();
  ClosureBook again{posegraph::RelaxerParams{}};
  EXPECT_TRUE(again.empty());
  again.load(map_);
  EXPECT_FALSE(again.empty());
  again.review(map_);
  const auto changes = again.apply(map_);
  EXPECT_TRUE(changes.dropped.empty());
  EXPECT_EQ(map_.edges().size(), edges);
}

}  // namespace
}  // namespace engram::pipeline
