// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/belief/bayes_filter.h"

#include "motion_models.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace engram::belief {
namespace {

/// Each layer times these factors, one a place. Returns the sum of all.
double scale(Layers& layers, const std::vector<double>& factors) {
  double total = 0;
  for (auto& layer : layers)
    for (std::size_t i = 0; i < layer.size(); ++i) total += layer[i] *= factors[i];
  return total;
}

}  // namespace

BayesFilter::BayesFilter(BeliefParams params, bool hasNewPlace)
    : params_(std::move(params)),
      hasNewPlace_(hasNewPlace),
      winnerTakesAll_(params_.filter == "winner_takes_all") {
  base::validate(params_);
  motion_ = makeMotionModel(params_);
  reset(0);
}

void BayesFilter::reset(std::size_t places) {
  motion_->reset();
  stepped_ = false;
  Layers joint(motion_->layers(), std::vector<double>(places, 0.0));
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
    joint[k].resize(places, each * motion_->share(k));
  }
  setJoint(std::move(joint), belief_.newPlace - fromNew);
}

std::vector<BayesFilter::Step> BayesFilter::learntSteps() const {
  std::vector<Step> steps;
  if (const auto* chain = dynamic_cast<const ChainMotion*>(motion_.get()))
    for (std::size_t k = 0; k < chain->layers(); ++k) steps.push_back({chain->size(k), chain->share(k)});
  return steps;
}

/// Adds `mass` evenly over all places.
void BayesFilter::spread(Layers& to, double mass) const {
  for (std::size_t k = 0; k < to.size(); ++k)
    for (double& p : to[k]) p += mass / static_cast<double>(to[k].size()) * motion_->share(k);
}

void BayesFilter::predict(const Adjacency& adjacency, const MotionHint& hint) {
  const std::size_t n = belief_.places.size();
  if (adjacency.size() != n) throw std::invalid_argument("BayesFilter::predict: another number of places");
  if (hint.hops && !(*hint.hops >= 0 && std::isfinite(*hint.hops)))
    throw std::invalid_argument("BayesFilter::predict: the distance travelled is negative or not finite");
  if (n == 0 || winnerTakesAll_) return;
  if (!adjacency.poses.empty() && adjacency.poses.size() != n)
    throw std::invalid_argument("BayesFilter::predict: another number of poses than places");
  if (stepped_) motion_->learn(joint_, 1.0 - belief_.newPlace);
  Layers moved(joint_.size(), std::vector<double>(n, 0.0));
  motion_->move(adjacency, joint_, hint, moved);

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
  if (winnerTakesAll_) {
    crown(likelihood);
    return true;
  }
  Layers joint = joint_;
  std::vector<double> factors(n);
  double total = 0;
  if (motion_->seesAll()) {
    for (std::size_t i = 0; i < n; ++i) factors[i] = likelihood.places[i] / largest;
    total = scale(joint, factors);
  } else {
    for (std::size_t k = 0; k < joint.size(); ++k)
      for (std::size_t i = 0; i < n; ++i) {
        const double evidence = std::max(0.0, likelihood.places[i] - likelihood.floor);
        const double l = likelihood.places[i] + (motion_->visible(k, i) - 1.0) * evidence;
        total += joint[k][i] *= l / largest;
      }
  }
  const double newPlace = hasNewPlace_ ? belief_.newPlace * (likelihood.newPlace / largest) : 0.0;
  if (!(total + newPlace > 1e-290)) return false;
  setJoint(std::move(joint), newPlace);
  return true;
}

/// The new place wins only where it is more likely than every place.
void BayesFilter::crown(const Likelihood& likelihood) {
  const auto& places = likelihood.places;
  Layers joint(joint_.size(), std::vector<double>(places.size(), 0.0));
  const auto best = std::max_element(places.begin(), places.end());
  const bool isNew = hasNewPlace_ && (best == places.end() || likelihood.newPlace > *best);
  if (!isNew)
    for (std::size_t k = 0; k < joint.size(); ++k)
      joint[k][static_cast<std::size_t>(best - places.begin())] = motion_->share(k);
  setJoint(std::move(joint), isNew ? 1.0 : 0.0);
}

/// Takes the joint distribution, scaled to sum to 1, and its marginal over steps.
void BayesFilter::setJoint(Layers joint, double newPlace) {
  double total = newPlace;
  for (const double sum : sums(joint)) total += sum;
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
