// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/vocabulary/view_index.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace engram::vocabulary {

using base::ViewId;
using base::WordId;

ViewIndex::ViewIndex(VocabularyTree tree) : tree_(std::move(tree)), postings_(tree_.words()) {}

ViewIndex::ViewIndex(VocabularyTree tree, std::span<const Described> views) : ViewIndex(std::move(tree)) {
  for (const auto& [view, descriptors] : views) add(view, tree_.wordsOf(*descriptors));
}

std::vector<ViewIndex::Count> ViewIndex::counted(Words words) const {
  std::vector<WordId> sorted(words.begin(), words.end());
  std::sort(sorted.begin(), sorted.end());
  if (!sorted.empty() && sorted.back().value >= postings_.size())
    throw std::invalid_argument("ViewIndex: a word that is none of the tree");
  std::vector<Count> counts;
  for (const WordId w : sorted) {
    if (counts.empty() || counts.back().word != w.value) counts.push_back({w.value, 0});
    ++counts.back().times;
  }
  return counts;
}

void ViewIndex::add(ViewId id, Words words) {
  if (!id.valid()) throw std::invalid_argument("ViewIndex::add: an invalid view");
  if (views_.contains(id)) throw std::invalid_argument("ViewIndex::add: the view is known already");
  View view{0, counted(words)};
  if (freeSlots_.empty()) {
    freeSlots_.push_back(static_cast<std::uint32_t>(slots_.size()));
    slots_.emplace_back();
  }
  view.slot = freeSlots_.back();
  freeSlots_.pop_back();
  slots_[view.slot] = id;
  for (const auto& [word, times] : view.counts) postings_[word].push_back({view.slot, times});
  views_.emplace(id, std::move(view));
}

void ViewIndex::remove(ViewId id) {
  const auto entry = views_.find(id);
  if (entry == views_.end()) return;
  const View view = std::move(entry->second);
  views_.erase(entry);
  slots_[view.slot] = ViewId();
  freeSlots_.push_back(view.slot);
  for (const Count& count : view.counts) {
    auto& list = postings_[count.word];
    *std::find_if(list.begin(), list.end(), [&](const Posting& p) { return p.slot == view.slot; }) =
        list.back();
    list.pop_back();
  }
}

std::vector<ViewVote> ViewIndex::query(Words words, std::size_t most) const {
  // Each sum runs over rising words, so that it does not depend on the order of the postings.
  std::vector<double> sums(slots_.size(), 0.0);
  for (const auto& [word, times] : counted(words)) {
    const auto& list = postings_[word];
    if (list.empty() || list.size() == views_.size()) continue;  // known nowhere, or everywhere
    const double idf = std::log(static_cast<double>(views_.size()) / static_cast<double>(list.size()));
    for (const Posting& p : list) sums[p.slot] += std::min(times, p.times) * idf;
  }
  std::vector<ViewVote> votes;
  for (std::size_t slot = 0; slot < sums.size(); ++slot)
    if (sums[slot] > 0) votes.push_back({slots_[slot], sums[slot]});
  const auto kept = votes.begin() + static_cast<std::ptrdiff_t>(std::min(most, votes.size()));
  std::partial_sort(votes.begin(), kept, votes.end(), [](const ViewVote& a, const ViewVote& b) {
    return a.score != b.score ? a.score > b.score : a.view < b.view;
  });
  votes.erase(kept, votes.end());
  return votes;
}

std::size_t ViewIndex::bytes() const {
  std::size_t sum = postings_.size() * sizeof postings_[0] + slots_.size() * sizeof slots_[0];
  for (const auto& list : postings_) sum += list.capacity() * sizeof(Posting);
  for (const auto& [id, view] : views_) sum += sizeof(id) + sizeof view + view.counts.size() * sizeof(Count);
  return sum;
}

}  // namespace engram::vocabulary
