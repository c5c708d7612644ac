// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/features/place_matcher.h"
#include "engram/pipeline/scorer.h"
#include "place_index.h"

#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace engram::pipeline {

types::Features longTermOf(const map::Place& place);

/// F eq (8) by descriptors, or the number of matches alone (D-03), every place by itself.
class LtmMatcher {
 public:
  explicit LtmMatcher(const PipelineParams& params)
      : match_(params.match),
        threads_(params.recognise.threads),
        counts_(params.recognise.scorer == "matched_points") {}

  /// @param longTerm features of a place
  void set(std::size_t place, const types::Features& longTerm);
  /// A place with so many of them, which are read when they are asked for. Only those asked for last are
  /// kept.
  void defer(std::size_t place, int size, const map::OnDemand<memory::PlaceMemory>& memory);
  std::size_t size() const { return sizes_.size(); }

  std::vector<double> scores(const types::Features& view) const;
  /// The same for these places alone, in their order.
  std::vector<double> scores(const types::Features& view, std::span<const std::size_t> places) const;

 private:
  struct Deferred {
    map::OnDemand<memory::PlaceMemory> memory;
    std::uint64_t asked = 0;  ///< when it was asked for last; 0: it is not here
  };

  int reference(std::size_t place) const;
  void resize(std::size_t place, int size);
  void fetch(std::span<const std::size_t> places) const;
  void dropOldest() const;

  features::MatchParams match_;
  int threads_;
  bool counts_;  // matches alone
  mutable features::PlaceMatcher matcher_;
  mutable std::map<std::size_t, Deferred> deferred_;
  mutable std::size_t fetched_ = 0;  // of these, that are here
  mutable std::uint64_t questions_ = 0;
  std::vector<int> sizes_;
  std::int64_t total_ = 0;  // of the sizes
};

/// `ltm_match` and `matched_points`: all places of a small map. In a larger one those that the index
/// proposes, those that are likely for other reasons, and a sample of the others, which stands for all of
/// these.
class LtmMatchScorer final : public Scorer {
 public:
  explicit LtmMatchScorer(const PipelineParams& params);

  void load(const map::TopologicalMap& map, std::span<const base::PlaceId> ids) override;
  void placeChanged(std::size_t index, const map::Place& place) override;
  void settled(const map::TopologicalMap& map) override;
  std::vector<double> scores(const types::Features& view, std::span<const std::size_t> likely) const override;
  std::vector<map::DerivedRow> changes() override;

 private:
  struct Asked {
    std::vector<std::size_t> places;
    std::size_t chosen = 0;  ///< so many for what they are, rising; the others are the sample
  };
  class Background;
  Asked toAsk(const std::vector<double>& votes, std::span<const std::size_t> likely) const;

  std::size_t proposals_;
  LtmMatcher matcher_;
  PlaceIndex index_;
  std::vector<base::PlaceId> ids_;  // of the places
};

}  // namespace engram::pipeline
