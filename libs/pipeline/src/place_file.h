// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/features.h"
#include "place_words.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace engram::pipeline {

/// An inverted file: which places have a word, and with which signatures. Equal contents give equal votes,
/// bit by bit, whatever changes led to them.
class PlaceFile {
 public:
  explicit PlaceFile(PlaceWords words) : words_(std::move(words)), postings_(words_.size()) {}

  const PlaceWords& words() const { return words_; }

  /// A place is new, or its features are others now. Numbers need not be dense.
  void set(std::size_t place, const types::Features& features) { set(place, words_.wordsOf(features)); }
  /// The same with the words of the features, in any order; all must be below words().size().
  void set(std::size_t place, std::span<const PlaceWord> words);
  /// Room for so many features with each word.
  void reserve(std::span<const std::uint32_t> counts);
  /// The words of these places, each by rising word and signature.
  std::vector<std::vector<PlaceWord>> wordsOf(std::span<const std::size_t> places) const;

  /// How much the features of an image speak for each place, by number. Each feature of a place adds for each
  /// one of the image with its word log(N / n_w), with n_w features of all N places that have the word, less
  /// the farther their signatures are apart; words that more features have say nothing.
  std::vector<double> votes(const types::Features& view) const;

 private:
  struct Postings {  // parallel, in no order
    std::vector<std::uint32_t> places;
    std::vector<std::uint64_t> signatures;
  };
  void remove(std::size_t place);

  PlaceWords words_;
  std::vector<Postings> postings_;                   // of each word
  std::vector<std::vector<std::uint16_t>> wordsOf_;  // of each place
};

}  // namespace engram::pipeline
