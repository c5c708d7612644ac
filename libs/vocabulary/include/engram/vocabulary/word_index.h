// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/vocabulary/inverted_index.h"
#include "engram/vocabulary/word_dictionary.h"

namespace engram::vocabulary {

/// The appearance side of a map of Angeli et al.: incremental dictionary and inverted index, kept in step.
/// An image is first recognised, then learnt:
///
///     const auto seen = words.recognise(features.descriptors);
///     … belief, verification, place = known one or new one …
///     words.learn(place, view, features.descriptors, seen.matches);
class WordIndex {
 public:
  /// @throws base::ConfigError when a parameter is out of range.
  explicit WordIndex(const WordParams& params) : dictionary_(params) {}

  struct Recognition {
    std::vector<WordMatch> matches;  ///< parallel to the descriptors
    std::vector<Vote> votes;         ///< see InvertedIndex::vote()
  };
  /// Changes nothing. The result does not depend on `threads`.
  /// @throws base::Error when the descriptors are of another kind or dimension than the words.
  Recognition recognise(const types::Descriptors& descriptors, int threads = 1) const;

  /// Adds the image as a view of the place; features without a word found new ones.
  /// @throws std::invalid_argument when the view is known already or `matches` is not from recognise() on
  /// these descriptors and this content.
  void learn(base::PlaceId place, base::ViewId view, const types::Descriptors& descriptors,
             std::span<const WordMatch> matches);

  /// Forget a view or a place; words that are nowhere seen any more are dropped. Unknown ones are no error.
  void removeView(base::ViewId view);
  void removePlace(base::PlaceId place);

  const WordDictionary& dictionary() const { return dictionary_; }
  const InvertedIndex& index() const { return index_; }

  /// All of it, parameters too, as bytes with magic, version and checksum. What is read back goes on exactly
  /// as the original would.
  std::vector<std::uint8_t> serialised() const;
  /// @throws base::Error on any damage and on a newer version.
  static WordIndex parse(std::span<const std::uint8_t> bytes);

 private:
  friend class WordIndexCodec;
  void drop(std::span<const base::WordId> words);

  WordDictionary dictionary_;
  InvertedIndex index_;
};

}  // namespace engram::vocabulary
