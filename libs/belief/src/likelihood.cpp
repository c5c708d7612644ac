// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/belief/likelihood.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace engram::belief {
namespace {

constexpr double kNormalMad = 1.4826;    // standard deviation of normal deviates over their median distance
constexpr std::size_t kPriorPlaces = 5;  // what is known of unknown places counts as so many of the map

struct Moments {
  double mean = 0, sigma = 0;
};

Moments moments(std::span<const double> values) {
  Moments m;
  if (values.empty()) return m;
  const auto n = static_cast<double>(values.size());
  for (const double v : values) m.mean += v / n;
  double variance = 0;
  for (const double v : values) variance += (v - m.mean) * (v - m.mean) / n;
  m.sigma = std::sqrt(variance);
  return m;
}

void check(std::span<const double> similarities, const Adjacency& adjacency) {
  if (similarities.size() != adjacency.size())
    throw std::invalid_argument("likelihood: one similarity for each place is needed");
  for (const double s : similarities)
    if (!(s >= 0 && s <= 1)) throw std::invalid_argument("likelihood: a similarity is outside [0, 1]");
}

double largestOf(const Likelihood& l) {
  return std::max(l.newPlace, l.places.empty() ? 0.0 : *std::max_element(l.places.begin(), l.places.end()));
}

/// Makes the largest 1 and lifts all by the floor, strictly increasing.
void normalise(Likelihood& l, double floor) {
  const double largest = largestOf(l);
  const auto lift = [&](double p) { return largest > 0 ? floor + (1 - floor) * p / largest : 1.0; };
  for (double& p : l.places) p = lift(p);
  l.newPlace = lift(l.newPlace);
  l.floor = floor;
}

double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

/// Neighbours see much of the same: each value becomes a mean of its place and those around it, by diffusion
/// along the edges until a peak is so many hops wide. What a place gives to a neighbour it gets from it too,
/// or the ends of a chain would win.
std::vector<double> smooth(std::vector<double> values, const Adjacency& adjacency, double sigmaHops) {
  constexpr double kShare = 0.5;  // that moves at each step: the variance grows by as much [hops^2]
  const long steps = std::lround(sigmaHops * sigmaHops / kShare);
  std::vector<double> next(values.size());
  const auto& near = adjacency.neighbours;
  for (long step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      next[i] = values[i];
      for (const int neighbour : near[i]) {
        const auto j = static_cast<std::size_t>(neighbour);
        const auto edges = static_cast<double>(std::max(near[i].size(), near[j].size()));
        next[i] += kShare / edges * (values[j] - values[i]);
      }
    }
    std::swap(values, next);
  }
  return values;
}

/// Where the similarities of an image that come by chance lie.
struct Background {
  double median = 0, spread = 1;
  double deviates(double similarity) const { return (similarity - median) / spread; }
};

Background backgroundOf(std::span<const double> similarities, const BeliefParams& params) {
  std::vector<double> values(similarities.begin(), similarities.end());
  values.resize(values.size() + kPriorPlaces, params.new_place_similarity);
  Background background{.median = medianOf(values)};
  for (double& value : values) value = std::abs(value - background.median);
  background.spread =
      params.sigma_z > 0 ? params.sigma_z : std::max(params.sigma_z_min, kNormalMad * medianOf(values));
  return background;
}

/// Places by how far they stand out; the new place by its similarity, or it shows the background alone, the
/// mean of exp(evidence * z) over normal deviates z. `background` is a share of the whole evidence for the
/// places, not of that for each, so that a lone right place is believed in a map of any size.
Likelihood standingOut(std::span<const double> similarities, const Adjacency& adjacency,
                       const BeliefParams& params, std::optional<double> newPlace) {
  const std::vector<double> z = smooth(standardised(similarities, params), adjacency, params.peak_sigma);
  Likelihood l;
  if (z.empty()) return {.places = {}, .newPlace = 1.0};
  double logNew = 0.5 * params.evidence * params.evidence;
  if (newPlace)
    logNew = std::max(logNew, params.evidence * backgroundOf(similarities, params).deviates(*newPlace));
  const double top = std::max(logNew, params.evidence * *std::max_element(z.begin(), z.end()));
  double total = 0;
  for (const double deviate : z) {
    l.places.push_back(std::exp(params.evidence * deviate - top));
    total += l.places.back();
  }
  l.newPlace = std::exp(logNew - top);
  l.floor = params.background / (1 - params.background) * total / static_cast<double>(z.size());
  for (double& p : l.places) p += l.floor;
  l.newPlace += l.floor;
  const double largest = largestOf(l);
  for (double& p : l.places) p /= largest;
  l.newPlace /= largest;
  l.floor /= largest;
  return l;
}

/// F eq (9) in logarithms: far from s = 1 the values themselves would underflow.
Likelihood pointwise(std::span<const double> similarities, const BeliefParams& params, double sigma) {
  const bool gaussian = params.likelihood == "gaussian";
  const auto logarithm = [&](double s) {
    return gaussian ? -(1 - s) * (1 - s) / (2 * sigma * sigma) : s / (sigma * sigma);
  };
  double largest = logarithm(params.new_place_similarity);
  for (const double s : similarities) largest = std::max(largest, logarithm(s));
  Likelihood l;
  for (const double s : similarities) l.places.push_back(std::exp(logarithm(s) - largest));
  l.newPlace = std::exp(logarithm(params.new_place_similarity) - largest);
  return l;
}

bool isPeak(std::span<const double> similarities, const Adjacency& adjacency, std::size_t place) {
  const auto& near = adjacency.neighbours[place];
  return std::all_of(near.begin(), near.end(),
                     [&](int j) { return similarities[static_cast<std::size_t>(j)] <= similarities[place]; });
}

/// F eq (10), (11): see F-E12.
Likelihood sumOfGaussians(std::span<const double> similarities, const Adjacency& adjacency,
                          const BeliefParams& params, double sigma) {
  const double own = params.new_place_similarity;
  const double largest =
      similarities.empty() ? 0.0 : *std::max_element(similarities.begin(), similarities.end());
  const double bound = std::max(largest, own) - sigma;
  const int radius = static_cast<int>(std::ceil(4 * params.peak_sigma));
  Likelihood l;
  l.places.assign(similarities.size(), 0.0);
  HopSearch search(adjacency);
  for (std::size_t i = 0; i < similarities.size(); ++i) {
    if (similarities[i] < bound || !isPeak(similarities, adjacency, i)) continue;
    for (const auto& hop : search.within(static_cast<int>(i), radius)) {
      const double d = hop.hops / params.peak_sigma;
      l.places[static_cast<std::size_t>(hop.place)] += similarities[i] * std::exp(-0.5 * d * d);
    }
  }
  l.newPlace = own >= bound ? own : 0.0;
  return l;
}

/// A-E11, with guards: no votes at all leave everything equal.
Likelihood angeli(std::span<const double> similarities) {
  const Moments m = moments(similarities);
  Likelihood l;
  for (const double s : similarities)
    l.places.push_back(m.mean > 0 && s > m.mean + m.sigma ? (s - m.sigma) / m.mean : 1.0);
  l.newPlace = m.sigma > 0 ? m.mean / m.sigma + 1.0 : 1.0;
  return l;
}

}  // namespace

std::vector<double> standardised(std::span<const double> similarities, const BeliefParams& params) {
  const Background background = backgroundOf(similarities, params);
  std::vector<double> z;
  for (const double s : similarities) z.push_back(background.deviates(s));
  return z;
}

double similaritySpread(std::span<const double> similarities, const BeliefParams& params) {
  if (params.sigma_z > 0) return params.sigma_z;
  return std::max(params.sigma_z_min, moments(similarities).sigma);
}

Likelihood likelihood(std::span<const double> similarities, const Adjacency& adjacency,
                      const BeliefParams& params, std::optional<double> newPlace) {
  check(similarities, adjacency);
  if (params.likelihood == "standardised") return standingOut(similarities, adjacency, params, newPlace);
  const double sigma = similaritySpread(similarities, params);
  Likelihood l;
  if (params.likelihood == "angeli")
    l = angeli(similarities);
  else if (params.sum_of_gaussians)
    l = sumOfGaussians(similarities, adjacency, params, sigma);
  else
    l = pointwise(similarities, params, sigma);
  normalise(l, params.floor);
  return l;
}

}  // namespace engram::belief
