// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ltm_scorer.h"

#include "engram/base/rng.h"
#include "engram/pipeline/place_match.h"

#include <algorithm>
#include <numeric>
#include <optional>

namespace engram::pipeline {
namespace {

constexpr std::size_t kMostFetched = 2000;  // places in a file whose features are kept here: 40 KB each
constexpr std::size_t kSample = 48;         // places that stand for those that were not looked at

/// Numbers of the largest values; of equal ones the earlier.
std::vector<std::size_t> largest(const std::vector<double>& values, std::size_t most) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::size_t n = std::min(most, order.size());
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(n);
  std::nth_element(order.begin(), end, order.end(), [&](std::size_t a, std::size_t b) {
    return values[a] != values[b] ? values[a] > values[b] : a < b;
  });
  order.resize(n);
  return order;
}

}  // namespace

types::Features longTermOf(const map::Place& place) {
  const memory::PlaceMemory& memory = place.memory;
  return memory.features.subset(memory.longTerm());
}

void LtmMatcher::set(std::size_t place, const types::Features& longTerm) {
  if (const auto old = deferred_.find(place); old != deferred_.end()) {
    if (old->second.asked > 0) --fetched_;
    deferred_.erase(old);
  }
  resize(place, static_cast<int>(longTerm.size()));
  matcher_.set(place, longTerm);
}

void LtmMatcher::defer(std::size_t place, int size, const map::OnDemand<memory::PlaceMemory>& memory) {
  set(place, {});
  resize(place, size);
  deferred_[place].memory = memory;
}

void LtmMatcher::resize(std::size_t place, int size) {
  sizes_.resize(std::max(sizes_.size(), place + 1), 0);
  total_ += size - sizes_[place];
  sizes_[place] = size;
}

void LtmMatcher::fetch(std::span<const std::size_t> places) const {
  ++questions_;
  for (const std::size_t place : places) {
    const auto at = deferred_.find(place);
    if (at == deferred_.end()) continue;
    if (at->second.asked == 0) {
      const memory::PlaceMemory memory = at->second.memory.read();
      matcher_.set(place, memory.features.subset(memory.longTerm()));
      ++fetched_;
    }
    at->second.asked = questions_;
  }
  if (fetched_ > kMostFetched) dropOldest();
}

/// Half of those that are here, but none that was asked for just now.
void LtmMatcher::dropOldest() const {
  std::vector<std::uint64_t> times;
  for (const auto& [place, deferred] : deferred_)
    if (deferred.asked > 0) times.push_back(deferred.asked);
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  const std::uint64_t kept = std::min(*middle, questions_);
  for (auto& [place, deferred] : deferred_) {
    if (deferred.asked == 0 || deferred.asked >= kept) continue;
    deferred.asked = 0;
    --fetched_;
    matcher_.remove(place);
  }
}

std::vector<double> LtmMatcher::scores(const types::Features& view) const {
  std::vector<std::size_t> all(size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return scores(view, all);
}

std::vector<double> LtmMatcher::scores(const types::Features& view,
                                       std::span<const std::size_t> places) const {
  fetch(places);
  const std::vector<int> counts = matcher_.ratioMatchCounts(view, places, match_, threads_);
  std::vector<double> result(places.size());
  for (std::size_t k = 0; k < result.size(); ++k)
    result[k] = similarity(counts[k], counts_ ? static_cast<int>(view.size()) : reference(places[k]));
  return result;
}

/// F eq (8) divides by the size of the memory, and so a place that remembers little wins by accident: it
/// counts as one of mean size.
int LtmMatcher::reference(std::size_t place) const {
  return std::max(sizes_[place], static_cast<int>(total_ / static_cast<std::int64_t>(sizes_.size())));
}

/// What a place that was not matched would score, by what it got of the votes. Where the votes put it among
/// the places of the sample, there its score is among theirs: so the scores of all of them are spread as if
/// each had been matched, which is what evidence is measured against. Places with equal votes, most often
/// none, share the scores of those of the sample by lot, which is another for each image.
class LtmMatchScorer::Background {
 public:
  Background(const std::vector<double>& votes, const std::vector<double>& matched, const Asked& asked)
      : scores_(matched.begin() + static_cast<std::ptrdiff_t>(asked.chosen), matched.end()),
        lots_(static_cast<std::uint64_t>(std::accumulate(votes.begin(), votes.end(), 0.0))) {
    for (std::size_t k = asked.chosen; k < asked.places.size(); ++k) votes_.push_back(votes[asked.places[k]]);
    std::sort(votes_.begin(), votes_.end());
    std::sort(scores_.begin(), scores_.end());
  }

  double scoreFor(std::size_t place, double votes) const {
    if (scores_.empty()) return 0.0;
    const auto [below, above] = std::equal_range(votes_.begin(), votes_.end(), votes);
    auto rank = static_cast<std::size_t>(below - votes_.begin());
    if (below != above) rank += lots_.fork(place).below(static_cast<std::uint32_t>(above - below));
    return scores_[std::min(rank, scores_.size() - 1)];
  }

 private:
  std::vector<double> votes_, scores_;
  base::Rng lots_;
};

LtmMatchScorer::LtmMatchScorer(const PipelineParams& params)
    : proposals_(static_cast<std::size_t>(params.recognise.proposals)),
      matcher_(params),
      index_(static_cast<std::size_t>(params.recognise.exhaustive_places)) {}

/// What lies beside the map spares looking at what lies in it.
void LtmMatchScorer::load(const map::TopologicalMap& map, std::span<const base::PlaceId> ids) {
  std::map<std::size_t, int> known;
  if (const auto& kept = map.content().derived)
    known = index_.restore(*kept, ids.size(), [&](std::uint32_t id) -> std::optional<std::size_t> {
      const auto at = std::lower_bound(ids.begin(), ids.end(), base::PlaceId(id));
      if (at == ids.end() || *at != base::PlaceId(id)) return std::nullopt;
      return static_cast<std::size_t>(at - ids.begin());
    });
  ids_.assign(ids.begin(), ids.end());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const map::Place& place = map.place(ids[i]);
    const auto size = known.find(i);
    if (size == known.end())
      placeChanged(i, place);
    else if (place.memory.isHere())
      matcher_.set(i, longTermOf(place));
    else
      matcher_.defer(i, size->second, place.memory);
  }
  settled(map);
}

std::vector<map::DerivedRow> LtmMatchScorer::changes() {
  return index_.changes([this](std::size_t place) { return ids_[place].value; });
}

void LtmMatchScorer::placeChanged(std::size_t index, const map::Place& place) {
  const types::Features longTerm = longTermOf(place);
  ids_.resize(std::max(ids_.size(), index + 1));
  ids_[index] = place.id;
  matcher_.set(index, longTerm);
  index_.set(index, longTerm);
}

void LtmMatchScorer::settled(const map::TopologicalMap& map) {
  index_.settle(ids_.size(), [&](std::size_t i) { return longTermOf(map.place(ids_[i])); });
}

std::vector<double> LtmMatchScorer::scores(const types::Features& view,
                                           std::span<const std::size_t> likely) const {
  if (!index_.ready()) return matcher_.scores(view);
  const std::vector<double> votes = index_.votes(view);
  const Asked asked = toAsk(votes, likely);
  const std::vector<double> matched = matcher_.scores(view, asked.places);
  const Background background(votes, matched, asked);
  std::vector<double> result(votes.size());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = background.scoreFor(i, votes[i]);
  for (std::size_t k = 0; k < matched.size(); ++k) result[asked.places[k]] = matched[k];
  return result;
}

/// Proposed and likely places, then those of the sample that are neither.
LtmMatchScorer::Asked LtmMatchScorer::toAsk(const std::vector<double>& votes,
                                            std::span<const std::size_t> likely) const {
  Asked asked{largest(votes, proposals_), 0};
  auto& places = asked.places;
  places.insert(places.end(), likely.begin(), likely.end());
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  asked.chosen = places.size();
  for (std::size_t k = 0; k < kSample; ++k) {
    const std::size_t place = (2 * k + 1) * votes.size() / (2 * kSample);
    const auto end = places.begin() + static_cast<std::ptrdiff_t>(asked.chosen);
    if (!std::binary_search(places.begin(), end, place)) places.push_back(place);
  }
  return asked;
}

}  // namespace engram::pipeline
