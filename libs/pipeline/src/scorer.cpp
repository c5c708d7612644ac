// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/scorer.h"

#include "engram/vocabulary/word_index.h"
#include "ltm_scorer.h"
#include "tree_search.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace engram::pipeline {
namespace {

class WordScorer : public Scorer {
 public:
  explicit WordScorer(const PipelineParams& params)
      : rescore_(static_cast<std::size_t>(params.recognise.rescore)),
        threads_(params.recognise.threads),
        words_(params.words),
        matcher_(params) {}

  /// The dictionary learns after the map. A place that has learnt is indexed anew, as one view.
  void placeChanged(std::size_t index, const map::Place& place) override {
    const auto number = static_cast<std::uint32_t>(index);
    const types::Features longTerm = longTermOf(place);
    words_.removePlace(base::PlaceId(number));
    const auto seen = words_.dictionary().lookup(longTerm.descriptors, threads_);
    words_.learn(base::PlaceId(number), base::ViewId(number), longTerm.descriptors, seen);
    if (rescore_ > 0) matcher_.set(index, longTerm);
  }

  std::vector<double> scores(const types::Features& view, std::span<const std::size_t>) const override {
    std::vector<double> result(words_.index().places(), 0.0);
    const double most = words_.index().maxVote();
    for (const auto& vote : words_.recognise(view.descriptors, threads_).votes)
      result[vote.place.value] = most > 0 ? std::min(1.0, vote.score / most) : 0.0;
    return rescore_ > 0 ? rescored(view, result) : result;
  }

 private:
  std::vector<double> rescored(const types::Features& view, const std::vector<double>& votes) const {
    std::vector<std::size_t> best(votes.size());
    std::iota(best.begin(), best.end(), std::size_t{0});
    const auto n = static_cast<std::ptrdiff_t>(std::min(rescore_, best.size()));
    std::partial_sort(best.begin(), best.begin() + n, best.end(), [&](std::size_t a, std::size_t b) {
      return votes[a] != votes[b] ? votes[a] > votes[b] : a < b;
    });
    best.resize(static_cast<std::size_t>(n));
    const std::vector<double> matched = matcher_.scores(view, best);
    const double least = matched.empty() ? 0.0 : *std::min_element(matched.begin(), matched.end());
    std::vector<double> result(votes.size(), least);
    for (std::size_t k = 0; k < best.size(); ++k) result[best[k]] = matched[k];
    return result;
  }

  std::size_t rescore_;
  int threads_;
  vocabulary::WordIndex words_;
  LtmMatcher matcher_;  // empty without `rescore`
};

/// K-14, over the votes of the best.
class TreeScorer : public Scorer {
 public:
  explicit TreeScorer(const PipelineParams& params) : search_(params, TreeSearch::Of::kPlaces) {}

  void load(const map::TopologicalMap& map, std::span<const base::PlaceId> ids) override {
    ids_.assign(ids.begin(), ids.end());
    search_.load(map);
  }
  void placeChanged(std::size_t index, const map::Place& place) override {
    if (index == ids_.size()) ids_.push_back(place.id);
  }
  void settled(const map::TopologicalMap& map) override { search_.follow(map); }

  std::vector<double> scores(const types::Features& view, std::span<const std::size_t>) const override {
    std::vector<double> result(ids_.size(), 0.0);
    const auto found = search_.find(view, kShare);
    for (const auto& [place, score] : found) {
      const auto at = std::lower_bound(ids_.begin(), ids_.end(), place);
      if (found.front().score > 0)
        result[static_cast<std::size_t>(at - ids_.begin())] = score / found.front().score;
    }
    return result;
  }

 private:
  static constexpr int kShare = 4;  // of those that geometry is asked about
  TreeSearch search_;
  std::vector<base::PlaceId> ids_;  // by index; they rise
};

}  // namespace

std::unique_ptr<Scorer> makeScorer(const PipelineParams& params) {
  if (params.recognise.scorer == "vocabulary_tree") return std::make_unique<TreeScorer>(params);
  if (params.recognise.scorer == "tfidf_incremental") return std::make_unique<WordScorer>(params);
  return std::make_unique<LtmMatchScorer>(params);
}

}  // namespace engram::pipeline
