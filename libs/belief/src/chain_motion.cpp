// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "motion_models.h"

#include <numeric>

namespace engram::belief {
namespace {

double sum(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); }

void scaleToOne(std::vector<double>& v) {
  const double total = sum(v);
  for (double& x : v) x /= total;
}

/// Share of the blind steps in the distribution that is used: a robot that stops or turns must not surprise
/// it.
constexpr double kBlindShare = 0.1;

}  // namespace

ChainMotion::ChainMotion(const BeliefParams& params) : params_(params), blind_(params) {
  const int last = params_.advance_max * params_.advance_resolution;
  for (int k = -last; k <= last; ++k)
    blindSteps_.push_back(gaussian(1.0 * k / params_.advance_resolution, params_.sigma_hops));
  scaleToOne(blindSteps_);
  reset();
}

double ChainMotion::size(std::size_t k) const {
  return static_cast<double>(k) / params_.advance_resolution - params_.advance_max;
}

void ChainMotion::learn(const Layers& joint, double known) {
  if (known <= 0) return;
  const std::vector<double> masses = sums(joint);
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    const double count = masses[k] / known;
    learnt_[k] = params_.advance_forgetting * learnt_[k] + (1 - params_.advance_forgetting) * count;
  }
  scaleToOne(learnt_);
  for (std::size_t k = 0; k < steps_.size(); ++k)
    steps_[k] = (1 - kBlindShare) * learnt_[k] + kBlindShare * blindSteps_[k];
}

void ChainMotion::move(const Adjacency& adjacency, const Layers& from, const MotionHint& hint, Layers& to) {
  const Layers left{moveAlong(adjacency, choose(from, hint), to)};
  Layers moved{std::vector<double>(adjacency.size(), 0.0)};
  blind_.move(adjacency, left, hint, moved);
  for (std::size_t k = 0; k < to.size(); ++k)
    for (std::size_t i = 0; i < adjacency.size(); ++i) to[k][i] += moved.front()[i] * steps_[k];
}

/// p(place, next step): like the last one, or drawn anew; weighted by the distance travelled where that is
/// known.
Layers ChainMotion::choose(const Layers& from, const MotionHint& hint) const {
  std::vector<double> places(from.front().size(), 0.0);
  for (const auto& layer : from)
    for (std::size_t i = 0; i < layer.size(); ++i) places[i] += layer[i];
  Layers next = from;
  double total = 0;
  for (std::size_t k = 0; k < next.size(); ++k) {
    const double weight =
        hint.hops ? gaussian(std::abs(size(k)) - *hint.hops, params_.sigma_odometry) + 1e-6 : 1.0;
    for (std::size_t i = 0; i < next[k].size(); ++i) {
      const double drawn = (1 - params_.advance_persistence) * steps_[k] * places[i];
      next[k][i] = weight * (params_.advance_persistence * from[k][i] + drawn);
      total += next[k][i];
    }
  }
  const double factor = total > 0 ? sum(places) / total : 0.0;
  for (auto& layer : next)
    for (double& p : layer) p *= factor;
  return next;
}

/// The place that each step from -furthest to furthest leads to from each place; -1 where the chain ends.
std::vector<std::vector<int>> ChainMotion::stepsAlong(const Adjacency& adjacency, int furthest) {
  const auto middle = static_cast<std::size_t>(furthest);
  std::vector<std::vector<int>> reached(2 * middle + 1, std::vector<int>(adjacency.size(), -1));
  std::iota(reached[middle].begin(), reached[middle].end(), 0);
  const auto next = [](const std::vector<int>& from, const std::vector<int>& by, std::vector<int>& to) {
    for (std::size_t i = 0; i < from.size(); ++i)
      if (from[i] >= 0) to[i] = by[static_cast<std::size_t>(from[i])];
  };
  for (std::size_t step = 1; step <= middle; ++step) {
    next(reached[middle + step - 1], adjacency.successor, reached[middle + step]);
    next(reached[middle - step + 1], adjacency.predecessor, reached[middle - step]);
  }
  return reached;
}

/// Moves every layer along the chain by its step; a step between two whole ones goes to both, in proportion.
/// What is past the end of the chain, and the share that moves blindly in any case, is returned.
std::vector<double> ChainMotion::moveAlong(const Adjacency& adjacency, const Layers& from, Layers& to) const {
  const std::size_t n = adjacency.size();
  const int furthest = params_.advance_max + 1;
  const auto reached = stepsAlong(adjacency, furthest);
  std::vector<double> blind(n, 0.0);
  for (std::size_t k = 0; k < from.size(); ++k) {
    const int whole = static_cast<int>(std::floor(size(k)));
    const double part = size(k) - whole;
    for (const int step : {whole, whole + 1}) {
      const double share = step == whole ? 1.0 - part : part;
      const auto& places = reached[static_cast<std::size_t>(step + furthest)];
      for (std::size_t i = 0; share > 0 && i < n; ++i) {
        const double steered = places[i] < 0 ? 0.0 : (1.0 - params_.advance_blind) * share * from[k][i];
        if (places[i] >= 0) to[k][static_cast<std::size_t>(places[i])] += steered;
        blind[i] += share * from[k][i] - steered;
      }
    }
  }
  return blind;
}

}  // namespace engram::belief
