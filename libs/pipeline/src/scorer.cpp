// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/scorer.h"

#include "engram/vocabulary/view_index.h"
#include "engram/vocabulary/word_index.h"
#include "ltm_scorer.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

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

/// K-14. Before settled() only descriptors are collected: the tree is trained on all of them together, or
/// never.
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

  void settled(const map::TopologicalMap&) override {
    if (index_ || std::exchange(settled_, true)) return;
    std::vector<const types::Descriptors*> images;
    for (const auto& d : waiting_)
      if (!d.empty()) images.push_back(&d);
    if (images.empty()) return;
    index_.emplace(vocabulary::VocabularyTree::train(images, params_));
    for (std::size_t i = 0; i < waiting_.size(); ++i) enter(i, waiting_[i]);
    waiting_.clear();
  }

  std::vector<double> scores(const types::Features& view, std::span<const std::size_t>) const override {
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
  bool settled_ = false;
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
