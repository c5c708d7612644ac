// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "place_words.h"

#include <cstdint>
#include <span>
#include <vector>

namespace engram::pipeline {

// What an index keeps beside the map (docs/map-format.md). A row of another version, or one that is cut
// short, throws base::Error.

/// The words of a whole index, and at how many places they are learnt anew.
struct StoredVocabulary {
  PlaceWords words;
  std::uint64_t learnAt = 0;
};
std::vector<std::uint8_t> encodeVocabulary(const PlaceWords& words, std::uint64_t learnAt);
StoredVocabulary decodeVocabulary(std::span<const std::uint8_t> row);

/// The words of one place, one for each of its long-term features, by rising word and signature.
struct StoredWords {
  std::uint64_t tag = 0;  ///< of the words, PlaceWords::tag()
  std::vector<PlaceWord> words;
};
std::vector<std::uint8_t> encodeWords(const StoredWords& place);
StoredWords decodeWords(std::span<const std::uint8_t> row);

}  // namespace engram::pipeline
