// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/belief/channel.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace engram::belief {
namespace {

constexpr double kRate = 0.1;         // of learning: ten images
constexpr double kLeastTrust = 0.05;  // what a channel needs to be heard again at another hour

constexpr double kUsualRate = 0.2;  // steps of the median, per image that differs [deviates]
constexpr double kOrdinary = 1;     // usual deviates that any place may have

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  const double meanA = std::accumulate(a.begin(), a.end(), 0.0) / n;
  const double meanB = std::accumulate(b.begin(), b.end(), 0.0) / n;
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - meanA) * (b[i] - meanB);
    aa += (a[i] - meanA) * (a[i] - meanA);
    bb += (b[i] - meanB) * (b[i] - meanB);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0.0;
}

}  // namespace

Channel::Channel(BeliefParams params, double trust)
    : params_(std::move(params)),
      first_(std::clamp(trust, kLeastTrust, 1.0 - params_.background)),
      trust_(first_) {}

Likelihood Channel::likelihood(std::span<const double> similarities, const Adjacency& adjacency,
                               std::optional<double> newPlace) const {
  BeliefParams params = params_;
  params.background = 1.0 - trust_;
  return belief::likelihood(corrected(similarities), adjacency, params, newPlace);
}

void Channel::watch(std::span<const double> similarities) {
  if (params_.likelihood != "standardised") return;  // those of the papers stay as they are
  std::vector<double> z = standardised(similarities, params_);
  usual_.resize(z.size(), 0.0);
  const double differs = last_.size() == z.size() ? std::clamp(1.0 - correlation(z, last_), 0.0, 1.0) : 1.0;
  for (std::size_t i = 0; i < z.size(); ++i)
    usual_[i] += kUsualRate * differs * std::clamp(z[i] - usual_[i], -1.0, 1.0);
  last_ = std::move(z);
}

std::vector<double> Channel::corrected(std::span<const double> similarities) const {
  std::vector<double> result(similarities.begin(), similarities.end());
  if (usual_.empty() || result.empty()) return result;
  const std::vector<double> z = standardised(similarities, params_);
  const auto [low, high] = std::minmax_element(z.begin(), z.end());
  if (!(*high > *low)) return result;
  const auto at = [&](auto i) { return result[static_cast<std::size_t>(i - z.begin())]; };
  const double spread = (at(high) - at(low)) / (*high - *low);
  for (std::size_t i = 0; i < std::min(result.size(), usual_.size()); ++i)
    result[i] = std::clamp(result[i] - spread * std::max(0.0, usual_[i] - kOrdinary), 0.0, 1.0);
  return result;
}

/// Of a likelihood, the floor is the part that the channel does not vouch for.
void Channel::learn(const Likelihood& given, const Belief& after) {
  double held = 0, known = 0;
  for (std::size_t i = 0; i < given.places.size(); ++i) {
    known += after.places[i];
    held += after.places[i] * (1.0 - given.floor / given.places[i]);
  }
  if (known <= 0) return;
  const double share = trust_ + kRate * known * (held / known - trust_);
  trust_ = std::clamp(share, kLeastTrust, 1.0 - params_.background);
}

}  // namespace engram::belief
