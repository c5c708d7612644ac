// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/features/place_matcher.h"

#include "engram/base/parallel.h"
#include "matching_detail.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace engram::features {

struct PlaceMatcher::State {
  std::vector<PreparedSet> places;
  types::DescriptorKind kind = types::DescriptorKind::kInt8;
  int dim = 0;  // 0 until the first place that is not empty
};

PlaceMatcher::PlaceMatcher() : state_(std::make_unique<State>()) {}
PlaceMatcher::~PlaceMatcher() = default;
PlaceMatcher::PlaceMatcher(PlaceMatcher&&) noexcept = default;
PlaceMatcher& PlaceMatcher::operator=(PlaceMatcher&&) noexcept = default;

void PlaceMatcher::set(std::size_t place, const types::Features& features) {
  PreparedSet prepared(detail::quantisedFeatures(features));
  if (prepared.size > 0) {
    if (state_->dim == 0) {
      state_->kind = prepared.kind;
      state_->dim = prepared.dim;
    }
    if (prepared.kind != state_->kind || prepared.dim != state_->dim)
      throw std::invalid_argument("PlaceMatcher: descriptors of another kind or dimension");
  }
  if (place >= state_->places.size()) state_->places.resize(place + 1);
  state_->places[place] = std::move(prepared);
}

void PlaceMatcher::remove(std::size_t place) {
  if (place < state_->places.size()) state_->places[place] = PreparedSet();
}

std::size_t PlaceMatcher::size() const { return state_->places.size(); }

std::vector<int> PlaceMatcher::ratioMatchCounts(const types::Features& query, const MatchParams& params,
                                                int threads) const {
  std::vector<std::size_t> all(size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return ratioMatchCounts(query, all, params, threads);
}

std::vector<int> PlaceMatcher::ratioMatchCounts(const types::Features& query,
                                                std::span<const std::size_t> places,
                                                const MatchParams& params, int threads) const {
  if (std::any_of(places.begin(), places.end(), [this](std::size_t i) { return i >= size(); }))
    throw std::invalid_argument("PlaceMatcher: no such place");
  const PreparedSet prepared(detail::quantisedFeatures(query));
  const SimdLevel level = supportedSimd();
  std::vector<int> counts(places.size(), 0);
  base::parallelFor(places.size(), threads, [&](std::size_t k) {
    const PreparedSet& place = state_->places[places[k]];
    counts[k] = static_cast<int>(detail::matchPrepared(level, prepared, place, params).size());
  });
  return counts;
}

std::vector<types::Match> PlaceMatcher::matches(const types::Features& query, std::size_t place,
                                                const MatchParams& params) const {
  if (place >= size()) throw std::invalid_argument("PlaceMatcher: no such place");
  const PreparedSet prepared(detail::quantisedFeatures(query));
  return detail::matchPrepared(supportedSimd(), prepared, state_->places[place], params);
}

}  // namespace engram::features
