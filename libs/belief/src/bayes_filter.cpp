// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/belief/bayes_filter.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace engram::belief {
namespace {

double sum(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); }

double gaussian(double x, double sigma) { return std::exp(-0.5 * (x / sigma) * (x / sigma)); }

void scaleToOne(std::vector<double>& v) {
  const double total = sum(v);
  for (double& x : v) x /= total;
}

/// Share of the blind steps in the distribution that is used: a robot that stops or turns must not surprise
/// it.
constexpr double kBlindShare = 0.1;

}  // namespace

BayesFilter::BayesFilter(BeliefParams params, bool hasNewPlace)
    : params_(std::move(params)), hasNewPlace_(hasNewPlace) {
  base::validate(params_);
  if (params_.advance == "learned") {
    const int last = params_.advance_max * params_.advance_resolution;
    for (int k = -last; k <= last; ++k)
      blindSteps_.push_back(gaussian(1.0 * k / params_.advance_resolution, params_.sigma_hops));
    scaleToOne(blindSteps_);
  }
  reset(0);
}

void BayesFilter::reset(std::size_t places) {
  steps_ = learnt_ = blindSteps_;
  stepped_ = false;
  Layers joint(std::max<std::size_t>(1, steps_.size()), std::vector<double>(places, 0.0));
  const double newPlace = !hasNewPlace_ ? 0.0 : places == 0 ? 1.0 : params_.new_place_prior;
  spread(joint, 1.0 - newPlace);
  setJoint(std::move(joint), newPlace);
}

void BayesFilter::grow(std::size_t places, double massOfAdded) {
  const std::size_t before = belief_.places.size();
  if (places < before || !(massOfAdded >= 0 && massOfAdded <= 1))
    throw std::invalid_argument("BayesFilter::grow: fewer places than before, or no probability");
  if (places == before) return;
  if (before == 0 && !hasNewPlace_) return reset(places);
  const double fromNew = std::min(belief_.newPlace, massOfAdded);
  const double others = 1.0 - belief_.newPlace;
  double missing = massOfAdded - fromNew;
  if (before == 0) missing = 0;  // nothing else to take from
  const double keep = others > 0 ? std::max(0.0, 1.0 - missing / others) : 1.0;
  const double each = (fromNew + missing) / static_cast<double>(places - before);
  Layers joint = joint_;
  for (std::size_t k = 0; k < joint.size(); ++k) {
    for (double& p : joint[k]) p *= keep;
    joint[k].resize(places, each * (steps_.empty() ? 1.0 : steps_[k]));
  }
  setJoint(std::move(joint), belief_.newPlace - fromNew);
}

double BayesFilter::stepSize(std::size_t k) const {
  return static_cast<double>(k) / params_.advance_resolution - params_.advance_max;
}

/// Expected counts of the steps under the posterior, with forgetting.
void BayesFilter::learnSteps() {
  if (steps_.empty() || !stepped_) return;
  const double known = 1.0 - belief_.newPlace;
  if (known <= 0) return;
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    const double count = sum(joint_[k]) / known;
    learnt_[k] = params_.advance_forgetting * learnt_[k] + (1 - params_.advance_forgetting) * count;
  }
  scaleToOne(learnt_);
  for (std::size_t k = 0; k < steps_.size(); ++k)
    steps_[k] = (1 - kBlindShare) * learnt_[k] + kBlindShare * blindSteps_[k];
}

/// p(place, next step): like the last one, or drawn anew; weighted by the distance travelled where that is
/// known.
BayesFilter::Layers BayesFilter::chooseSteps(const MotionHint& hint) const {
  Layers next = joint_;
  double total = 0;
  for (std::size_t k = 0; k < next.size(); ++k) {
    const double weight =
        hint.hops ? gaussian(std::abs(stepSize(k)) - *hint.hops, params_.sigma_odometry) + 1e-6 : 1.0;
    for (std::size_t i = 0; i < next[k].size(); ++i) {
      const double drawn = (1 - params_.advance_persistence) * steps_[k] * belief_.places[i];
      next[k][i] = weight * (params_.advance_persistence * joint_[k][i] + drawn);
      total += next[k][i];
    }
  }
  const double factor = total > 0 ? sum(belief_.places) / total : 0.0;
  for (auto& layer : next)
    for (double& p : layer) p *= factor;
  return next;
}

/// Moves every layer along the chain by its step; a step between two whole ones goes to both, in proportion.
/// What is past the end of the chain, and the share that moves blindly in any case, is returned.
std::vector<double> BayesFilter::moveAlong(const Adjacency& adjacency, const Layers& from, Layers& to) const {
  const std::size_t n = adjacency.size();
  const int furthest = params_.advance_max + 1;
  std::vector<std::vector<int>> reached;  // the place that each whole step leads to
  for (int step = -furthest; step <= furthest; ++step) {
    auto& places = reached.emplace_back(n);
    for (std::size_t i = 0; i < n; ++i) places[i] = adjacency.along(static_cast<int>(i), step);
  }
  std::vector<double> blind(n, 0.0);
  for (std::size_t k = 0; k < from.size(); ++k) {
    const int whole = static_cast<int>(std::floor(stepSize(k)));
    const double part = stepSize(k) - whole;
    for (const int step : {whole, whole + 1}) {
      const double share = step == whole ? 1.0 - part : part;
      const int row = step + furthest;
      const auto& places = reached[static_cast<std::size_t>(row)];
      for (std::size_t i = 0; share > 0 && i < n; ++i) {
        const double steered = places[i] < 0 ? 0.0 : (1.0 - params_.advance_blind) * share * from[k][i];
        if (places[i] >= 0) to[k][static_cast<std::size_t>(places[i])] += steered;
        blind[i] += share * from[k][i] - steered;
      }
    }
  }
  return blind;
}

/// F eq (7), Gaussian on hops: see F-E2. Each row of the transition is normalised. Adds to `to`.
void BayesFilter::moveBlindly(const Adjacency& adjacency, const std::vector<double>& from,
                              const MotionHint& hint, Layers& to) const {
  const double centre = hint.hops.value_or(params_.expected_hops);
  const double sigma = hint.hops ? params_.sigma_odometry : params_.sigma_hops;
  const int radius =
      params_.hop_radius + static_cast<int>(std::min(std::ceil(centre), 1.0 * params_.hop_radius));
  std::vector<double> weight;
  for (int d = 0; d <= radius; ++d) weight.push_back(gaussian(d - centre, sigma) + 1e-12);
  std::vector<double> moved(from.size(), 0.0);
  HopSearch search(adjacency);
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (from[i] <= 0) continue;
    const auto reached = search.within(static_cast<int>(i), radius);
    double total = 0;
    for (const auto& hop : reached) total += weight[static_cast<std::size_t>(hop.hops)];
    for (const auto& hop : reached)
      moved[static_cast<std::size_t>(hop.place)] +=
          from[i] * weight[static_cast<std::size_t>(hop.hops)] / total;
  }
  for (std::size_t k = 0; k < to.size(); ++k)
    for (std::size_t i = 0; i < moved.size(); ++i) to[k][i] += moved[i] * (steps_.empty() ? 1.0 : steps_[k]);
}

/// Adds `mass` evenly over all places.
void BayesFilter::spread(Layers& to, double mass) const {
  for (std::size_t k = 0; k < to.size(); ++k)
    for (double& p : to[k])
      p += mass / static_cast<double>(to[k].size()) * (steps_.empty() ? 1.0 : steps_[k]);
}

void BayesFilter::predict(const Adjacency& adjacency, const MotionHint& hint) {
  const std::size_t n = belief_.places.size();
  if (adjacency.size() != n) throw std::invalid_argument("BayesFilter::predict: another number of places");
  if (hint.hops && !(*hint.hops >= 0 && std::isfinite(*hint.hops)))
    throw std::invalid_argument("BayesFilter::predict: the distance travelled is negative or not finite");
  if (n == 0) return;
  learnSteps();
  Layers moved(joint_.size(), std::vector<double>(n, 0.0));
  const auto blind = steps_.empty() ? belief_.places : moveAlong(adjacency, chooseSteps(hint), moved);
  moveBlindly(adjacency, blind, hint, moved);

  const double wasNew = belief_.newPlace, known = 1.0 - wasNew;
  const double leave = hasNewPlace_ ? params_.new_place_prior : 0.0;
  for (auto& layer : moved)
    for (double& p : layer) p *= (1.0 - leave) * (1.0 - params_.teleport);
  spread(moved, (1.0 - leave) * params_.teleport * known + (1.0 - params_.new_place_persistence) * wasNew);
  setJoint(std::move(moved), leave * known + params_.new_place_persistence * wasNew);
  stepped_ = true;
}

bool BayesFilter::update(const Likelihood& likelihood) {
  const std::size_t n = belief_.places.size();
  if (likelihood.places.size() != n)
    throw std::invalid_argument("BayesFilter::update: another number of places");
  const auto check = [](double l) {
    if (!(l >= 0 && std::isfinite(l)))
      throw std::invalid_argument("BayesFilter::update: a likelihood is negative or not finite");
  };
  check(likelihood.newPlace);
  double largest = hasNewPlace_ ? likelihood.newPlace : 0.0;
  for (const double l : likelihood.places) {
    check(l);
    largest = std::max(largest, l);
  }
  if (largest <= 0) return false;
  Layers joint = joint_;
  double total = 0;
  for (auto& layer : joint)
    for (std::size_t i = 0; i < n; ++i) total += layer[i] *= likelihood.places[i] / largest;
  const double newPlace = hasNewPlace_ ? belief_.newPlace * (likelihood.newPlace / largest) : 0.0;
  if (!(total + newPlace > 1e-290)) return false;
  setJoint(std::move(joint), newPlace);
  return true;
}

/// Takes the joint distribution, scaled to sum to 1, and its marginal over steps.
void BayesFilter::setJoint(Layers joint, double newPlace) {
  double total = newPlace;
  for (const auto& layer : joint) total += sum(layer);
  const double factor = total > 0 ? 1.0 / total : 0.0;
  joint_ = std::move(joint);
  belief_.newPlace = newPlace * factor;
  belief_.places.assign(joint_.front().size(), 0.0);
  for (auto& layer : joint_)
    for (std::size_t i = 0; i < layer.size(); ++i) belief_.places[i] += layer[i] *= factor;
}

int BayesFilter::best() const {
  if (belief_.places.empty()) return -1;
  return static_cast<int>(std::max_element(belief_.places.begin(), belief_.places.end()) -
                          belief_.places.begin());
}

double BayesFilter::neighbourhoodMass(const Adjacency& adjacency, int place, int hops) const {
  double mass = 0;
  HopSearch search(adjacency);
  for (const auto& hop : search.within(place, hops))
    mass += belief_.places[static_cast<std::size_t>(hop.place)];
  return mass;
}

double BayesFilter::interpolatedPeak(const Adjacency& adjacency, int place) const {
  const auto mass = [&](int i) { return i < 0 ? 0.0 : belief_.places[static_cast<std::size_t>(i)]; };
  const double before = mass(adjacency.along(place, -1)), at = mass(place),
               after = mass(adjacency.along(place, 1));
  const double total = before + at + after;
  return total > 0 ? place + (after - before) / total : place;
}

}  // namespace engram::belief
