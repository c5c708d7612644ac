// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The transition that follows odometry, against dense sums over all states and in a building whose
// places look alike.
#include "worlds.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace engram::belief {
namespace {

constexpr double kTurn = 2 * 3.14159265358979323846;

BeliefParams odometryParams(int headings = 8) {
  BeliefParams p;
  p.advance = "odometry";
  p.advance_headings = headings;
  return p;
}

MotionHint hint(const Eigen::Vector2d& step, double heading, double spacing = 1.0) {
  return {step.norm() / spacing, OdometryStep{step, heading, spacing}};
}

Adjacency scattered(int n, base::Rng& rng) {
  Adjacency a = randomGraph(n, n / 3, rng);
  for (int i = 0; i < n; ++i)
    a.poses.emplace_back(rng.uniform(-4, 4), rng.uniform(-4, 4), rng.uniform(-3, 3));
  return a;
}

/// The definition, written out: every state to every state.
class DenseOdometry {
 public:
  DenseOdometry(const Adjacency& a, const BeliefParams& p) : a_(a), p_(p), hops_(allHops(a)) {
    const auto states = a.size() * static_cast<std::size_t>(p.advance_headings);
    belief_.assign(states, 1.0 / static_cast<double>(states));
  }

  void predict(const MotionHint& h) {
    const std::size_t n = a_.size();
    const auto layers = static_cast<std::size_t>(p_.advance_headings);
    std::vector<double> turned(belief_.size()), next(belief_.size(), 0.0);
    for (std::size_t k = 0; k < layers; ++k)
      for (std::size_t i = 0; i < n; ++i)
        turned[k * n + i] = 0.96 * belief_[k * n + i] + 0.02 * (belief_[((k + 1) % layers) * n + i] +
                                                                belief_[((k + layers - 1) % layers) * n + i]);
    heading_ = h.odometry->heading;
    pending_ += h.odometry->step;
    if (pending_.norm() >= 0.75 * h.odometry->spacing) {  // the mass follows
      const double sigma = p_.sigma_odometry * h.odometry->spacing;
      for (std::size_t k = 0; k < layers; ++k) {
        const double angle = kTurn * static_cast<double>(k) / static_cast<double>(layers);
        const Eigen::Vector2d step = Eigen::Rotation2Dd(angle) * pending_;
        for (std::size_t i = 0; i < n; ++i) {
          const double mass = turned[k * n + i];
          std::vector<double> steered(n, 0.0), blind(n, 0.0);
          double sum = std::exp(-2.0), blindSum = 0;
          for (std::size_t j = 0; j < n; ++j) {
            const double r = (a_.poses[i].head<2>() + step - a_.poses[j].head<2>()).norm() / sigma;
            if (r <= 3) sum += steered[j] = std::exp(-0.5 * r * r);
            const double d = (hops_[i][j] - *h.hops) / p_.sigma_odometry;
            const int radius =
                p_.hop_radius + static_cast<int>(std::min(std::ceil(*h.hops), 1.0 * p_.hop_radius));
            if (hops_[i][j] <= radius) blindSum += blind[j] = std::exp(-0.5 * d * d) + 1e-12;
          }
          for (std::size_t j = 0; j < n; ++j) {
            next[k * n + j] += mass * (1 - p_.advance_blind) * steered[j] / sum;
            next[k * n + j] += mass * p_.advance_blind * blind[j] / blindSum;
          }
          for (double& x : next)
            x += mass * (1 - p_.advance_blind) * std::exp(-2.0) / sum / static_cast<double>(next.size());
        }
      }
      pending_.setZero();
    } else {
      next = belief_;
    }
    for (double& x : next) x = (1 - p_.teleport) * x + p_.teleport / static_cast<double>(next.size());
    belief_ = next;
  }

  void update(const Likelihood& l) {
    double total = 0;
    for (std::size_t s = 0; s < belief_.size(); ++s) {
      const std::size_t i = s % a_.size(), k = s / a_.size();
      double seen = 1;
      if (p_.view_sigma > 0) {
        const double angle =
            heading_ + kTurn * static_cast<double>(k) / p_.advance_headings - a_.poses[i].z();
        const double apart = std::atan2(std::sin(angle), std::cos(angle));
        double mean = 0;
        for (int degree = -180; degree < 180; ++degree)
          mean += std::exp(-0.5 * std::pow((degree + 0.5) * kTurn / 360 / p_.view_sigma, 2)) / 360;
        seen = std::exp(-0.5 * std::pow(apart / p_.view_sigma, 2)) / mean;
      }
      total += belief_[s] *= p_.floor + seen * (l.places[i] - p_.floor);
    }
    for (double& x : belief_) x /= total;
  }

  double at(std::size_t i) const {
    double p = 0;
    for (std::size_t s = i; s < belief_.size(); s += a_.size()) p += belief_[s];
    return p;
  }

 private:
  const Adjacency& a_;
  BeliefParams p_;
  std::vector<std::vector<int>> hops_;
  std::vector<double> belief_;
  double heading_ = 0;
  Eigen::Vector2d pending_ = Eigen::Vector2d::Zero();
};

TEST(OdometryMotion, EqualsTheDenseSums) {
  for (const double view : {0.0, 0.6}) {
    base::Rng rng(5);
    const Adjacency a = scattered(40, rng);
    BeliefParams p = odometryParams();
    p.view_sigma = view;
    BayesFilter filter(p, false);
    filter.reset(a.size());
    DenseOdometry dense(a, p);
    for (int t = 0; t < 9; ++t) {
      const MotionHint h = hint({rng.uniform(-1.5, 1.5), rng.uniform(-1.5, 1.5)}, rng.uniform(-3, 3), 0.9);
      filter.predict(a, h);
      dense.predict(h);
      Likelihood l;
      l.floor = p.floor;
      for (std::size_t i = 0; i < a.size(); ++i) l.places.push_back(rng.uniform(p.floor, 1.0));
      l.places[3] = 1.0;
      ASSERT_TRUE(filter.update(l));
      dense.update(l);
      for (std::size_t i = 0; i < a.size(); ++i)
        ASSERT_NEAR(filter.posterior().places[i], dense.at(i), 1e-9) << "view " << view << ", image " << t;
    }
  }
}

TEST(OdometryMotion, KeepsTheMassAndTheNewPlace) {
  base::Rng rng(6);
  const Adjacency a = scattered(30, rng);
  BayesFilter filter(odometryParams(), true);
  filter.reset(a.size());
  for (int t = 0; t < 5; ++t) {
    filter.predict(a, hint({rng.uniform(-5, 5), 0.3}, 0.1 * t));
    const auto& b = filter.posterior();
    EXPECT_NEAR(std::accumulate(b.places.begin(), b.places.end(), b.newPlace), 1.0, 1e-12);
    ASSERT_TRUE(filter.update(randomLikelihood(a.size(), rng)));
  }
}

TEST(OdometryMotion, DoesNotCareHowTheOdometryFrameLies) {
  base::Rng rng(7);
  const Adjacency a = scattered(30, rng);
  const double angle = kTurn / 8 * 3;
  BayesFilter one(odometryParams(), false), other(odometryParams(), false);
  one.reset(a.size());
  other.reset(a.size());
  for (int t = 0; t < 5; ++t) {
    const Eigen::Vector2d step(rng.uniform(-1, 1), rng.uniform(-1, 1));
    one.predict(a, hint(step, 0.2));
    other.predict(a, hint(Eigen::Rotation2Dd(angle) * step, 0.2 + angle));
    const Likelihood l = randomLikelihood(a.size(), rng);
    one.update(l);
    other.update(l);
  }
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_NEAR(one.posterior().places[i], other.posterior().places[i], 1e-9);
}

TEST(OdometryMotion, WithoutOdometryOrPosesItIsTheBlindModel) {
  base::Rng rng(8);
  Adjacency a = scattered(30, rng);
  BeliefParams none;
  none.advance = "none";
  BayesFilter blind(none, false), noHint(odometryParams(), false), noPoses(odometryParams(), false);
  for (BayesFilter* f : {&blind, &noHint, &noPoses}) f->reset(a.size());
  Adjacency bare = a;
  bare.poses.clear();
  for (int t = 0; t < 4; ++t) {
    blind.predict(a);
    noHint.predict(a);
    noPoses.predict(bare, {{}, OdometryStep{{1, 0}, 0, 1}});
    const Likelihood l = randomLikelihood(a.size(), rng);
    for (BayesFilter* f : {&blind, &noHint, &noPoses}) f->update(l);
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(noHint.posterior().places[i], blind.posterior().places[i], 1e-12);
    EXPECT_NEAR(noPoses.posterior().places[i], blind.posterior().places[i], 1e-12);
  }
}

/// One-metre places along an L-shaped round of corridors; every fifth place looks alike.
struct Block {
  Adjacency adjacency;
  std::vector<Eigen::Vector3d> route;
};
Block block() {
  Block b;
  Eigen::Vector2d at(0, 0);
  const auto side = [&](int quarter, int n) {
    const double heading = quarter * kTurn / 4;
    for (int i = 0; i < n; ++i, at += Eigen::Vector2d(std::cos(heading), std::sin(heading)))
      b.route.emplace_back(at.x(), at.y(), heading);
  };
  side(0, 16);
  side(1, 6);
  side(2, 9);
  side(1, 8);
  side(2, 7);
  side(3, 14);
  b.adjacency = ring(static_cast<int>(b.route.size()));
  b.adjacency.poses = b.route;
  return b;
}

/// Images from a random start, at half a place each, until the belief in the neighbourhood of one place
/// exceeds 0.8; how many, and whether it was the right one.
std::pair<int, bool> localise(const Block& b, const BeliefParams& p, bool tell, std::uint64_t seed) {
  base::Rng rng(seed);
  const auto n = static_cast<int>(b.route.size());
  BayesFilter filter(p, false);
  filter.reset(b.route.size());
  const int start = static_cast<int>(rng.below(static_cast<std::uint32_t>(n)));
  const double frame = rng.uniform(-3, 3);  // the odometry frame lies anywhere
  Eigen::Vector2d last(0, 0);
  for (int image = 0; image < 60; ++image) {
    const int place = (start + image / 2) % n;
    const Eigen::Vector3d& here = b.route[static_cast<std::size_t>(place)];
    const Eigen::Vector3d& next = b.route[static_cast<std::size_t>((place + 1) % n)];
    const Eigen::Vector2d at = image % 2 ? Eigen::Vector2d(0.5 * (here + next).head<2>()) : here.head<2>();
    MotionHint h;
    if (tell && image > 0) {
      const Eigen::Vector2d step = Eigen::Rotation2Dd(frame) * (at - last);
      h = hint(step + Eigen::Vector2d(0.03 * rng.normal(), 0.03 * rng.normal()), here.z() + frame);
    }
    last = at;
    filter.predict(b.adjacency, h);
    Likelihood l;
    for (int i = 0; i < n; ++i) {
      const double low = i == place ? 0.6 : i % 5 == place % 5 ? 0.4 : 0.02;
      l.places.push_back(rng.uniform(low, low < 0.1 ? 0.5 : 1.0));
    }
    filter.update(l);
    const int best = filter.best();
    if (filter.neighbourhoodMass(b.adjacency, best, 2) < 0.8) continue;
    const int apart = std::abs(best - place);
    return {image + 1, std::min(apart, n - apart) <= 2};
  }
  return {60, false};
}

TEST(OdometryMotion, LocalisesWherePlacesLookAlikeAndOthersDoNot) {
  const Block b = block();
  BeliefParams blind;
  blind.advance = "none";
  blind.expected_hops = 1.0;
  blind.sigma_hops = 1.0;
  struct Tally {
    double trials = 0;
    int wrong = 0;
  };
  const auto run = [&](const BeliefParams& p, bool tell) {
    Tally tally;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      const auto [images, right] = localise(b, p, tell, seed);
      tally.trials += images / 100.0;
      tally.wrong += !right;
    }
    return tally;
  };
  const Tally nothing = run(blind, false), chain = run({}, true), odometry = run(odometryParams(16), true);
  EXPECT_LT(odometry.trials, 0.7 * chain.trials);
  EXPECT_LT(chain.trials, nothing.trials);
  EXPECT_LE(odometry.wrong, 2);
}

TEST(OdometryMotion, ACameraThatLooksAheadRulesOutTheOtherDirection) {
  // Two places at one spot that face each other; the robot drives on from the one facing +x.
  Adjacency a = chain(4);
  a.poses = {{0, 0, 0}, {0, 0.1, kTurn / 2}, {1, 0, 0}, {1, 0.1, kTurn / 2}};
  BeliefParams p = odometryParams(8);
  p.view_sigma = 0.5;
  BayesFilter filter(p, false);
  filter.reset(4);
  for (int t = 0; t < 2; ++t) {
    filter.predict(a, hint({t, 0}, 0));
    filter.update(
        {t == 0 ? std::vector<double>{1, 1, 0.02, 0.02} : std::vector<double>{0.02, 0.02, 1, 1}, 0});
  }
  EXPECT_GT(filter.posterior().places[2], 5 * filter.posterior().places[3]);
}

TEST(OdometryMotion, RefusesPosesOfAnotherMap) {
  Adjacency a = chain(4);
  a.poses.resize(3);
  BayesFilter filter(odometryParams(), false);
  filter.reset(4);
  EXPECT_THROW(filter.predict(a), std::invalid_argument);
}

}  // namespace
}  // namespace engram::belief
