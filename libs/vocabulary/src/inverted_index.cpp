// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/vocabulary/inverted_index.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace engram::vocabulary {
namespace {

using base::PlaceId;
using base::ViewId;
using base::WordId;

template <class Postings>
auto at(Postings& postings, PlaceId place) {
  return std::lower_bound(postings.begin(), postings.end(), place,
                          [](const auto& posting, PlaceId p) { return posting.place < p; });
}

}  // namespace

void InvertedIndex::add(PlaceId place, ViewId id, std::span<const WordId> words) {
  if (!place.valid() || !id.valid()) throw std::invalid_argument("InvertedIndex::add: an invalid id");
  if (views_.contains(id)) throw std::invalid_argument("InvertedIndex::add: the view is known already");
  std::vector<WordId> sorted(words.begin(), words.end());
  std::sort(sorted.begin(), sorted.end());
  if (!sorted.empty() && !sorted.back().valid())
    throw std::invalid_argument("InvertedIndex::add: a feature without a word");
  View view{place, {}};
  for (const WordId w : sorted) {
    if (view.words.empty() || view.words.back().word != w) view.words.push_back({w, 0});
    ++view.words.back().count;
  }
  insert(id, std::move(view));
}

InvertedIndex::Place& InvertedIndex::placeFor(PlaceId id) {
  const auto [entry, isNew] = totals_.try_emplace(id);
  if (!isNew) return entry->second;
  // Slots in use and free ones are together 0 … n-1.
  entry->second.slot = static_cast<std::uint32_t>(totals_.size() + freeSlots_.size() - 1);
  if (!freeSlots_.empty()) {
    entry->second.slot = freeSlots_.back();
    freeSlots_.pop_back();
  }
  return entry->second;
}

void InvertedIndex::insert(ViewId id, View view) {
  Place& place = placeFor(view.place);
  place.views.push_back(id);
  for (const auto& [word, count] : view.words) {
    place.total += count;
    auto& postings = postings_[word];
    const auto posting = at(postings, view.place);
    if (posting != postings.end() && posting->place == view.place)
      posting->count += count;
    else
      postings.insert(posting, {view.place, place.slot, count});
  }
  views_.emplace(id, std::move(view));
}

std::vector<WordId> InvertedIndex::removeView(ViewId id) {
  std::vector<WordId> gone;
  const auto entry = views_.find(id);
  if (entry == views_.end()) return gone;
  const View view = std::move(entry->second);
  views_.erase(entry);
  const auto place = totals_.find(view.place);
  for (const auto& [word, count] : view.words) {
    place->second.total -= count;
    const auto list = postings_.find(word);
    const auto posting = at(list->second, view.place);
    posting->count -= count;
    if (posting->count > 0) continue;
    list->second.erase(posting);
    if (!list->second.empty()) continue;
    postings_.erase(list);
    gone.push_back(word);
  }
  std::erase(place->second.views, id);
  if (place->second.views.empty()) {
    freeSlots_.push_back(place->second.slot);
    totals_.erase(place);
  }
  return gone;
}

std::vector<WordId> InvertedIndex::removePlace(PlaceId place) {
  std::vector<WordId> gone;
  const auto entry = totals_.find(place);
  if (entry == totals_.end()) return gone;
  const auto views = entry->second.views;  // a copy: removeView() edits it
  for (const ViewId view : views) {
    const auto more = removeView(view);
    gone.insert(gone.end(), more.begin(), more.end());
  }
  std::sort(gone.begin(), gone.end());
  return gone;
}

std::vector<Vote> InvertedIndex::vote(std::span<const WordId> words) const {
  std::vector<WordId> distinct(words.begin(), words.end());
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  std::vector<double> sums(totals_.size() + freeSlots_.size(), 0.0);  // of n_wp log(N / n_w)
  std::vector<std::pair<PlaceId, std::uint32_t>> touched;             // with slot
  for (const WordId w : distinct) {
    const auto list = postings_.find(w);
    if (list == postings_.end()) continue;
    const double idf =
        std::log(static_cast<double>(totals_.size()) / static_cast<double>(list->second.size()));
    if (idf <= 0) continue;
    for (const Posting& p : list->second) {
      double& sum = sums[p.slot];
      if (sum == 0) touched.emplace_back(p.place, p.slot);
      sum += p.count * idf;
    }
  }
  std::sort(touched.begin(), touched.end());
  std::vector<Vote> votes;
  votes.reserve(touched.size());
  for (const auto& [place, slot] : touched)
    votes.push_back({place, sums[slot] / static_cast<double>(totals_.at(place).total)});
  return votes;
}

double InvertedIndex::maxVote() const {
  return totals_.empty() ? 0.0 : std::log(static_cast<double>(totals_.size()));
}

}  // namespace engram::vocabulary
