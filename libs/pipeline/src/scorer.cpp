// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/scorer.h"

#include "engram/base/parallel.h"
#include "engram/features/place_matcher.h"
#include "engram/pipeline/place_match.h"
#include "engram/vocabulary/view_index.h"
#include "engram/vocabulary/word_index.h"

#include <algorithm>
#include <numeric>
#include <optional>

namespace engram::pipeline {
namespace {

types::Features longTermOf(const map::Place& place) {
  return place.memory.features.subset(place.memory.longTerm());
}

class LtmMatchScorer : public Scorer {
 public:
  explicit LtmMatchScorer(const PipelineParams& params)
      : match_(params.match), threads_(params.recognise.threads) {}

  void placeChanged(std::size_t index, const map::Place& place) override {
    const types::Features longTerm = longTermOf(place);
    sizes_.resize(std::max(sizes_.size(), index + 1), 0);
    total_ += static_cast<int>(longTerm.size()) - sizes_[index];
    sizes_[index] = static_cast<int>(longTerm.size());
    matcher_.set(index, longTerm);
  }

  std::vector<double> scores(const types::Features& view) const override {
    const std::vector<int> counts = matcher_.ratioMatchCounts(view, match_, threads_);
    std::vector<double> result(sizes_.size());
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = similarity(counts[i], reference(i));
    return result;
  }

  /// The same for these places alone.
  std::vector<double> scores(const types::Features& view, const std::vector<std::size_t>& places) const {
    std::vector<double> result(places.size());
    base::parallelFor(places.size(), threads_, [&](std::size_t k) {
      const auto matches = matcher_.matches(view, places[k], match_);
      result[k] = similarity(static_cast<int>(matches.size()), reference(places[k]));
    });
    return result;
  }

 private:
  /// F eq (8) divides by the size of the memory, and so a place that remembers little wins by accident: it
  /// counts as one of mean size.
  int reference(std::size_t place) const {
    return std::max(sizes_[place], static_cast<int>(total_ / static_cast<std::int64_t>(sizes_.size())));
  }

  features::MatchParams match_;
  int threads_;
  features::PlaceMatcher matcher_;
  std::vector<int> sizes_;
  std::int64_t total_ = 0;  // of the sizes
};

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
    if (rescore_ > 0) matcher_.placeChanged(index, place);
  }

  std::vector<double> scores(const types::Features& view) const override {
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
  LtmMatchScorer matcher_;  // empty without `rescore`
};

/// K-14. Before loaded() only descriptors are collected: the tree is trained on all of them together.
class TreeScorer : public Scorer {
 public:
  explicit TreeScorer(const PipelineParams& params)
      : params_(params.tree), candidates_(params.views.candidates) {
    if (!params.views.vocabulary.empty())
      index_.emplace(vocabulary::VocabularyTree::load(params.views.vocabulary));
  }

  void placeChanged(std::size_t index, const map::Place& place) override {
    const types::Features longTerm = longTermOf(place);
    size_ = std::max(size_, index + 1);
    if (index_) return enter(index, longTerm.descriptors);
    waiting_.resize(size_);
    waiting_[index] = longTerm.descriptors;
  }

  void loaded() override {
    if (index_) return;
    std::vector<const types::Descriptors*> images;
    for (const auto& d : waiting_)
      if (!d.empty()) images.push_back(&d);
    if (images.empty()) return;
    index_.emplace(vocabulary::VocabularyTree::train(images, params_));
    for (std::size_t i = 0; i < waiting_.size(); ++i) enter(i, waiting_[i]);
    waiting_.clear();
  }

  std::vector<double> scores(const types::Features& view) const override {
    std::vector<double> result(size_, 0.0);
    if (!index_) return result;
    const auto votes = index_->query(index_->tree().wordsOf(view.descriptors), most());
    for (const auto& vote : votes)
      if (votes.front().score > 0) result[vote.view.value] = vote.score / votes.front().score;
    return result;
  }

 private:
  std::size_t most() const { return static_cast<std::size_t>(4 * candidates_); }
  void enter(std::size_t index, const types::Descriptors& descriptors) {
    const base::ViewId id(static_cast<std::uint32_t>(index));
    index_->remove(id);
    index_->add(id, index_->tree().wordsOf(descriptors));
  }

  vocabulary::TreeParams params_;
  int candidates_;
  std::size_t size_ = 0;
  std::optional<vocabulary::ViewIndex> index_;  // its views are the places, by index
  std::vector<types::Descriptors> waiting_;
};

}  // namespace

std::unique_ptr<Scorer> makeScorer(const PipelineParams& params) {
  if (params.recognise.scorer == "vocabulary_tree") return std::make_unique<TreeScorer>(params);
  if (params.recognise.scorer == "tfidf_incremental") return std::make_unique<WordScorer>(params);
  return std::make_unique<LtmMatchScorer>(params);
}

}  // namespace engram::pipeline
