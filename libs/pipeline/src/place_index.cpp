// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "place_index.h"

#include "place_rows.h"

#include <algorithm>
#include <utility>

namespace engram::pipeline {
namespace {

constexpr std::size_t kTeachers = 400;  // places that words are learnt from, at most
constexpr std::size_t kGrowth = 3;      // they are learnt anew when there are so many times as many places
constexpr std::size_t kLearningPlaces = 20;  // that come meanwhile: time enough for it
constexpr std::size_t kPlacesAnImage = 12;   // that are entered anew with an image: about 2 ms
constexpr std::uint64_t kSeed = 1;

/// All descriptors of places spread evenly over the map.
types::Descriptors sampled(std::size_t places, const PlaceIndex::Source& source) {
  types::Descriptors sample;
  const std::size_t n = std::min(places, kTeachers);
  for (std::size_t k = 0; k < n; ++k) {
    const types::Descriptors rows = types::quantised(source(places * k / n).descriptors);
    if (sample.empty()) sample = types::Descriptors(rows.kind(), rows.dim());
    for (std::size_t i = 0; i < rows.size(); ++i) sample.append(rows.row(i));
  }
  return sample;
}

}  // namespace

std::map<std::size_t, int> PlaceIndex::restore(const map::Derived& kept, std::size_t places,
                                               const NumberOf& numberOf) {
  if (places < learnAt_) return {};
  std::optional<StoredVocabulary> vocabulary;
  kept.read(map::DerivedKind::kWords,
            [&](std::uint32_t, std::span<const std::uint8_t> row) { vocabulary = decodeVocabulary(row); });
  if (!vocabulary) return {};
  learnAt_ = std::max(static_cast<std::size_t>(vocabulary->learnAt), places + 1);
  settled_ = wordsKept_ = true;
  PlaceFile& file = file_.emplace(std::move(vocabulary->words));
  std::map<std::size_t, int> sizes;
  const auto eachPlace = [&](const auto& take) {
    kept.read(map::DerivedKind::kPlaceWords, [&](std::uint32_t id, std::span<const std::uint8_t> row) {
      const auto place = numberOf(id);
      const StoredWords stored = decodeWords(row);
      const bool known = stored.tag == file.words().tag() &&
                         (stored.words.empty() || stored.words.back().word < file.words().size());
      if (place && known) take(*place, stored.words);
    });
  };
  std::vector<std::uint32_t> counts(file.words().size(), 0);
  eachPlace([&](std::size_t, const std::vector<PlaceWord>& words) {
    for (const PlaceWord& w : words) ++counts[w.word];
  });
  file.reserve(counts);
  eachPlace([&](std::size_t place, const std::vector<PlaceWord>& words) {
    file.set(place, words);
    sizes[place] = static_cast<int>(words.size());
  });
  return sizes;
}

std::vector<map::DerivedRow> PlaceIndex::changes(
    const std::function<std::uint32_t(std::size_t place)>& idOf) {
  std::vector<map::DerivedRow> rows;
  if (!file_ || (wordsKept_ && unkept_.empty())) return rows;
  const bool learning = learning_.valid() || next_;  // that has to begin anew
  if (!wordsKept_)
    rows.push_back({map::DerivedKind::kWords, 0, encodeVocabulary(file_->words(), learning ? 0 : learnAt_)});
  const std::vector<std::size_t> places(unkept_.begin(), unkept_.end());
  const auto words = file_->wordsOf(places);
  for (std::size_t k = 0; k < places.size(); ++k)
    rows.push_back(
        {map::DerivedKind::kPlaceWords, idOf(places[k]), encodeWords({file_->words().tag(), words[k]})});
  unkept_.clear();
  wordsKept_ = true;
  return rows;
}

void PlaceIndex::set(std::size_t place, const types::Features& features) {
  unkept_.insert(place);
  if (file_) file_->set(place, features);
  if (next_ && place < filled_) next_->set(place, features);
}

void PlaceIndex::settle(std::size_t places, const Source& source) {
  const bool first = !std::exchange(settled_, true);
  if (learning_.valid() && places >= takeAt_) {
    next_.emplace(learning_.get());
    filled_ = 0;
  }
  if (next_) return fill(places, kPlacesAnImage, source);
  if (learning_.valid() || places < learnAt_) return;
  types::Descriptors sample = sampled(places, source);
  if (sample.empty()) return;
  learnAt_ = kGrowth * places;
  if (first) {
    next_.emplace(PlaceWords::train(sample, kSeed));
    return fill(places, places, source);
  }
  takeAt_ = places + kLearningPlaces;
  learning_ = std::async(std::launch::async,
                         [sample = std::move(sample)] { return PlaceWords::train(sample, kSeed); });
}

/// Enters the next places; the new file takes over with the last one.
void PlaceIndex::fill(std::size_t places, std::size_t most, const Source& source) {
  for (const std::size_t end = std::min(places, filled_ + most); filled_ < end; ++filled_)
    next_->set(filled_, source(filled_));
  if (filled_ < places) return;
  file_ = std::exchange(next_, std::nullopt);
  wordsKept_ = false;
  for (std::size_t place = 0; place < places; ++place) unkept_.insert(place);
}

}  // namespace engram::pipeline
