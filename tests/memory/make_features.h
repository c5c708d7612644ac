// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/rng.h"
#include "engram/memory/fsh.h"

#include <vector>

namespace engram::memory {

/// Features whose descriptors are random unit vectors, one per identity: equal identities give equal
/// descriptors.
inline types::Features makeFeatures(const std::vector<int>& identities, const std::vector<float>& responses) {
  constexpr int kDim = 16;
  types::Features out;
  out.descriptors = types::Descriptors(types::DescriptorKind::kFloat, kDim);
  out.descriptors.resize(identities.size());
  for (std::size_t i = 0; i < identities.size(); ++i) {
    base::Rng rng(static_cast<std::uint64_t>(identities[i]));
    Eigen::Matrix<float, kDim, 1> d;
    for (int k = 0; k < kDim; ++k) d[k] = static_cast<float>(rng.normal());
    d.normalize();
    std::copy(d.data(), d.data() + kDim, reinterpret_cast<float*>(out.descriptors.mutableRow(i)));
    types::Keypoint keypoint;
    keypoint.x = static_cast<float>(identities[i]);
    keypoint.response = responses[i];
    out.keypoints.push_back(keypoint);
  }
  return out;
}

/// The true matches of a view to a memory: the same identity, kept in Keypoint::x.
inline std::vector<types::Match> trueMatches(const types::Features& view, const PlaceMemory& memory,
                                             float distance) {
  std::vector<types::Match> matches;
  for (std::size_t a = 0; a < view.size(); ++a)
    for (std::size_t b = 0; b < memory.features.size(); ++b)
      if (view.keypoints[a].x == memory.features.keypoints[b].x) {
        matches.push_back({static_cast<int>(a), static_cast<int>(b), distance});
        break;
      }
  return matches;
}

/// State of the feature with this identity; null when the memory does not hold it.
inline const FeatureState* find(const PlaceMemory& memory, int identity) {
  for (std::size_t i = 0; i < memory.states.size(); ++i)
    if (memory.features.keypoints[i].x == static_cast<float>(identity)) return &memory.states[i];
  return nullptr;
}

/// The paper's rule without the floor, so that small examples can be followed by hand.
inline FshParams bareParams() {
  FshParams params;
  params.ltm_min_features = 1;
  return params;
}

}  // namespace engram::memory
