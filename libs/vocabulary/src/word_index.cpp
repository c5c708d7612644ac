// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/vocabulary/word_index.h"

#include <stdexcept>

namespace engram::vocabulary {

WordIndex::Recognition WordIndex::recognise(const types::Descriptors& descriptors, int threads) const {
  Recognition r;
  r.matches = dictionary_.lookup(descriptors, threads);
  std::vector<base::WordId> words;
  for (const WordMatch& m : r.matches)
    if (m.found()) words.push_back(m.word);
  r.votes = index_.vote(words);
  return r;
}

void WordIndex::learn(base::PlaceId place, base::ViewId view, const types::Descriptors& descriptors,
                      std::span<const WordMatch> matches) {
  // Before the dictionary changes: it must not hold words that no view has.
  if (!place.valid() || !view.valid()) throw std::invalid_argument("WordIndex::learn: an invalid id");
  if (index_.views().contains(view))
    throw std::invalid_argument("WordIndex::learn: the view is known already");
  index_.add(place, view, dictionary_.learn(descriptors, matches));
}

void WordIndex::removeView(base::ViewId view) { drop(index_.removeView(view)); }

void WordIndex::removePlace(base::PlaceId place) { drop(index_.removePlace(place)); }

void WordIndex::drop(std::span<const base::WordId> words) {
  for (const base::WordId w : words) dictionary_.remove(w);
}

}  // namespace engram::vocabulary
