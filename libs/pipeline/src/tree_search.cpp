// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tree_search.h"

#include "ltm_scorer.h"

#include <algorithm>

namespace engram::pipeline {
namespace {

/// Views that come while a tree is trained: time enough for it, at two views a second.
constexpr std::size_t kTrainingViews = 20;

base::ViewId numberOf(base::PlaceId view) { return base::ViewId(view.value); }

std::future<vocabulary::VocabularyTree> trainLater(types::Descriptors sample,
                                                   const vocabulary::TreeParams& params) {
  return std::async(std::launch::async, [sample = std::move(sample), params] {
    const types::Descriptors* all = &sample;
    return vocabulary::VocabularyTree::train({&all, 1}, params);
  });
}

}  // namespace

TreeSearch::TreeSearch(const PipelineParams& params, Of of)
    : of_(of),
      params_(params.views),
      treeParams_(params.tree),
      match_(params.match),
      threads_(params.recognise.threads) {
  if (params_.vocabulary.empty())
    trainAt_ = static_cast<std::size_t>(params_.train_after);
  else
    index_.emplace(vocabulary::VocabularyTree::load(params_.vocabulary));
}

void TreeSearch::load(const map::TopologicalMap& map) {
  const std::size_t trainAt = std::exchange(trainAt_, 0);  // one tree for all
  if (of_ == Of::kPlaces && !index_ && !map.places().empty()) {
    training_ = trainLater(sampleOf(map), treeParams_);
    takeTree(map);
  } else {
    for (const auto& [id, place] : map.places()) add(map, id);
  }
  trainAt_ = trainAt > 0 && index_ ? grown(map) : trainAt;
  if (trainAt_ > 0 && map.places().size() >= trainAt_) startTraining(map);
  read_ = map.now();
}

void TreeSearch::follow(const map::TopologicalMap& map) {
  const map::MapChanges changes = map.changesSince(read_);
  for (const auto view : changes.removedPlaces) remove(view);
  for (const auto view : changes.memories) add(map, view);
}

void TreeSearch::add(const map::TopologicalMap& map, base::PlaceId view) {
  types::Features room;
  const types::Features& features = featuresOf(map.place(view), room);
  if (index_) {
    index_->remove(numberOf(view));  // what it remembered before
    index_->add(numberOf(view), index_->tree().wordsOf(features.descriptors));
  } else {
    const auto [slot, isNew] = slotOf_.try_emplace(view, slots_.size());
    if (isNew) slots_.push_back(view);
    matcher_.set(slot->second, features);
  }
  if (training_.valid() && --takeAt_ == 0) takeTree(map);
  if (!training_.valid() && trainAt_ > 0 && map.places().size() >= trainAt_) startTraining(map);
}

void TreeSearch::remove(base::PlaceId view) {
  if (index_) return index_->remove(numberOf(view));
  const auto at = slotOf_.find(view);
  if (at == slotOf_.end()) return;
  matcher_.remove(at->second);
  slots_[at->second] = {};
  slotOf_.erase(at);
}

std::vector<TreeSearch::Found> TreeSearch::find(const types::Features& image, int share) const {
  const auto most = static_cast<std::size_t>(share * params_.candidates);
  std::vector<Found> found;
  if (index_) {
    for (const auto& vote : index_->query(index_->tree().wordsOf(image.descriptors), most))
      found.push_back({base::PlaceId(vote.view.value), vote.score});
    return found;
  }
  if (slotOf_.empty()) return found;
  const std::vector<int> counts = matcher_.ratioMatchCounts(image, match_, threads_);
  for (std::size_t slot = 0; slot < slots_.size(); ++slot)
    if (slots_[slot].valid() && counts[slot] > 0)
      found.push_back({slots_[slot], static_cast<double>(counts[slot])});
  std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
    return a.score != b.score ? a.score > b.score : a.view < b.view;
  });
  found.resize(std::min(found.size(), most));
  return found;
}

const types::Features& TreeSearch::featuresOf(const map::Place& place, types::Features& room) const {
  if (of_ == Of::kViews) return place.memory->features;
  return room = longTermOf(place);
}

types::Descriptors TreeSearch::sampleOf(const map::TopologicalMap& map) const {
  std::vector<types::Features> rooms(of_ == Of::kPlaces ? map.places().size() : 1);
  std::vector<const types::Descriptors*> images;
  for (const auto& [id, place] : map.places()) {
    types::Features& room = rooms[of_ == Of::kPlaces ? images.size() : 0];
    images.push_back(&featuresOf(place, room).descriptors);
  }
  return vocabulary::VocabularyTree::sample(images, treeParams_);
}

/// The size of the map at which the next tree is trained.
std::size_t TreeSearch::grown(const map::TopologicalMap& map) const {
  return static_cast<std::size_t>(params_.retrain_growth * static_cast<double>(map.places().size()));
}

void TreeSearch::startTraining(const map::TopologicalMap& map) {
  training_ = trainLater(sampleOf(map), treeParams_);
  takeAt_ = kTrainingViews;
  trainAt_ = grown(map);
}

void TreeSearch::takeTree(const map::TopologicalMap& map) {
  index_.emplace(training_.get());
  types::Features room;
  for (const auto& [id, place] : map.places())
    index_->add(numberOf(id), index_->tree().wordsOf(featuresOf(place, room).descriptors));
  matcher_ = {};
  slots_.clear();
  slotOf_.clear();
}

}  // namespace engram::pipeline
