// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "view_search.h"

#include <algorithm>

namespace engram::pipeline {
namespace {

/// Views that come while a tree is trained: time enough for it, at two views a second.
constexpr std::size_t kTrainingViews = 20;

base::ViewId numberOf(base::PlaceId view) { return base::ViewId(view.value); }

}  // namespace

ViewSearch::ViewSearch(const PipelineParams& params)
    : params_(params.views),
      treeParams_(params.tree),
      match_(params.match),
      threads_(params.recognise.threads) {
  if (params_.vocabulary.empty())
    trainAt_ = static_cast<std::size_t>(params_.train_after);
  else
    index_.emplace(vocabulary::VocabularyTree::load(params_.vocabulary));
}

void ViewSearch::load(const map::TopologicalMap& map) {
  const std::size_t trainAt = std::exchange(trainAt_, 0);  // one tree for all
  for (const auto& [id, place] : map.places()) add(map, id);
  trainAt_ = trainAt;
  if (trainAt_ > 0 && map.places().size() >= trainAt_) startTraining(map);
  read_ = map.now();
}

void ViewSearch::follow(const map::TopologicalMap& map) {
  const map::MapChanges changes = map.changesSince(read_);
  for (const auto view : changes.removedPlaces) remove(view);
  for (const auto view : changes.memories) add(map, view);
}

void ViewSearch::add(const map::TopologicalMap& map, base::PlaceId view) {
  const types::Features& features = map.place(view).memory->features;
  if (index_) {
    index_->add(numberOf(view), index_->tree().wordsOf(features.descriptors));
  } else {
    slotOf_[view] = slots_.size();
    matcher_.set(slots_.size(), features);
    slots_.push_back(view);
  }
  if (training_.valid() && --takeAt_ == 0) takeTree(map);
  if (!training_.valid() && trainAt_ > 0 && map.places().size() >= trainAt_) startTraining(map);
}

void ViewSearch::remove(base::PlaceId view) {
  if (index_) return index_->remove(numberOf(view));
  const auto at = slotOf_.find(view);
  if (at == slotOf_.end()) return;
  matcher_.remove(at->second);
  slots_[at->second] = {};
  slotOf_.erase(at);
}

std::vector<ViewSearch::Found> ViewSearch::find(const types::Features& image) const {
  const auto most = static_cast<std::size_t>(params_.candidates);
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

void ViewSearch::startTraining(const map::TopologicalMap& map) {
  std::vector<const types::Descriptors*> images;
  for (const auto& [id, place] : map.places()) images.push_back(&place.memory->features.descriptors);
  training_ =
      std::async(std::launch::async,
                 [sample = vocabulary::VocabularyTree::sample(images, treeParams_), params = treeParams_] {
                   const types::Descriptors* all = &sample;
                   return vocabulary::VocabularyTree::train({&all, 1}, params);
                 });
  takeAt_ = kTrainingViews;
  trainAt_ = static_cast<std::size_t>(params_.retrain_growth * static_cast<double>(map.places().size()));
}

void ViewSearch::takeTree(const map::TopologicalMap& map) {
  std::vector<vocabulary::ViewIndex::Described> views;
  for (const auto& [id, place] : map.places())
    views.push_back({numberOf(id), &place.memory->features.descriptors});
  index_.emplace(training_.get(), views);
  matcher_ = {};
  slots_.clear();
  slotOf_.clear();
}

}  // namespace engram::pipeline
