// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/ids.h"

#include <cstdint>
#include <map>
#include <span>
#include <unordered_map>
#include <vector>

namespace engram::vocabulary {

/// How much the words of an image speak for a place.
struct Vote {
  base::PlaceId place;
  double score = 0;
  bool operator==(const Vote&) const = default;
};

/// Which words were seen in which places, from both ends: word -> places (to vote) and view -> words (to
/// remove). A place has one or more views. Equal contents give equal votes, bit by bit, whatever
/// additions and removals led to them.
class InvertedIndex {
 public:
  struct WordCount {
    base::WordId word;
    std::uint32_t count = 0;
    bool operator==(const WordCount&) const = default;
  };
  struct View {
    base::PlaceId place;
    std::vector<WordCount> words;  ///< by rising word
    bool operator==(const View&) const = default;
  };

  /// Adds a view of a place with the word of each of its features, in any order. No words are legal: the
  /// view counts as one all the same. @throws std::invalid_argument when the view is known already or a word
  /// or id is invalid.
  void add(base::PlaceId place, base::ViewId view, std::span<const base::WordId> words);

  /// Forget a view, or all views of a place; unknown ones are no error. They give the words that are nowhere
  /// seen any more, rising.
  std::vector<base::WordId> removeView(base::ViewId view);
  std::vector<base::WordId> removePlace(base::PlaceId place);

  /// tf-idf votes: every distinct word w of an image gives each place that has it n_wp / n_p * log(N /
  /// n_w), with n_wp occurrences in the n_p words of the place, and n_w of all N places that have it. Places
  /// with a vote only, by rising id; unknown and invalid words have none. A vote is at most maxVote().
  /// Places without one have score 0 and count as such in A-E11.
  std::vector<Vote> vote(std::span<const base::WordId> words) const;
  /// log N, of a place whose words are in no other and all in the image; scores divided by it are in [0, 1].
  double maxVote() const;

  std::size_t places() const { return totals_.size(); }
  std::size_t words() const { return postings_.size(); }
  const std::map<base::ViewId, View>& views() const { return views_; }
  bool operator==(const InvertedIndex& o) const { return views_ == o.views_; }  // the rest follows

 private:
  friend class WordIndexCodec;
  struct Posting {
    base::PlaceId place;
    std::uint32_t slot = 0;
    std::uint32_t count = 0;  // in all views of the place
  };
  struct Place {
    std::uint32_t slot = 0;  // dense number, for arrays over places; used again after removal
    std::vector<base::ViewId> views;
    std::uint64_t total = 0;  // n_p
  };

  void insert(base::ViewId id, View view);
  Place& placeFor(base::PlaceId id);

  std::map<base::ViewId, View> views_;
  std::map<base::PlaceId, Place> totals_;
  std::vector<std::uint32_t> freeSlots_;
  std::unordered_map<base::WordId, std::vector<Posting>> postings_;  // by rising place, never empty
};

}  // namespace engram::vocabulary
