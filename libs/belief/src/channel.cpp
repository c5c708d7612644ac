// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/belief/channel.h"

#include <algorithm>

namespace engram::belief {
namespace {

constexpr double kRate = 0.1;         // of learning: ten images
constexpr double kLeastTrust = 0.05;  // what a channel needs to be heard again at another hour

}  // namespace

Channel::Channel(BeliefParams params, double trust)
    : params_(std::move(params)),
      first_(std::clamp(trust, kLeastTrust, 1.0 - params_.background)),
      trust_(first_) {}

Likelihood Channel::likelihood(std::span<const double> similarities, const Adjacency& adjacency,
                               std::optional<double> newPlace) const {
  BeliefParams params = params_;
  params.background = 1.0 - trust_;
  return belief::likelihood(similarities, adjacency, params, newPlace);
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
