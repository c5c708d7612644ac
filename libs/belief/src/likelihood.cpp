// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/belief/likelihood.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace engram::belief {
namespace {

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

/// Makes the largest 1 and lifts all by the floor, strictly increasing.
void normalise(Likelihood& l, double floor) {
  double largest = l.newPlace;
  for (const double p : l.places) largest = std::max(largest, p);
  const auto lift = [&](double p) { return largest > 0 ? floor + (1 - floor) * p / largest : 1.0; };
  for (double& p : l.places) p = lift(p);
  l.newPlace = lift(l.newPlace);
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

double similaritySpread(std::span<const double> similarities, const BeliefParams& params) {
  if (params.sigma_z > 0) return params.sigma_z;
  return std::max(params.sigma_z_min, moments(similarities).sigma);
}

Likelihood likelihood(std::span<const double> similarities, const Adjacency& adjacency,
                      const BeliefParams& params) {
  check(similarities, adjacency);
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
