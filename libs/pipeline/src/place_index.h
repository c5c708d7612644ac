// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/derived.h"
#include "engram/types/features.h"
#include "place_file.h"
#include "place_words.h"

#include <cstddef>
#include <functional>
#include <future>
#include <map>
#include <optional>
#include <set>
#include <vector>

namespace engram::pipeline {

/// Which of many places may an image show? An inverted file over words that are learnt from the map itself,
/// once it has so many places that asking all of them costs more, and again whenever it has grown. While a
/// map grows that is done beside the work, and taken into use at images that do not depend on how long it
/// took: equal drives give equal maps.
class PlaceIndex {
 public:
  /// The features of a place by its number.
  using Source = std::function<types::Features(std::size_t place)>;

  using NumberOf = std::function<std::optional<std::size_t>(std::uint32_t id)>;

  /// @param from as many places need no index
  explicit PlaceIndex(std::size_t from) : learnAt_(from + 1) {}

  /// Whether it can be asked.
  bool ready() const { return file_.has_value(); }

  /// Takes over what lies beside a map, where that is whole and holds good. To be called before anything
  /// else. Returns how many features each place has of which it knows them; the others are to be set. A map
  /// of few places needs no index, and gets none.
  /// @param numberOf of the place with this id; none for one that is not in the map
  std::map<std::size_t, int> restore(const map::Derived& kept, std::size_t places, const NumberOf& numberOf);
  /// What has changed since, to be laid beside the map.
  std::vector<map::DerivedRow> changes(const std::function<std::uint32_t(std::size_t place)>& idOf);

  /// A place is new or has changed.
  void set(std::size_t place, const types::Features& features);
  /// To be called once for each image, when all changes of the map were told. The first time, with all that
  /// the map has had from the start, the index is made at once.
  void settle(std::size_t places, const Source& source);

  /// How much each place looks like being that of the image, by number; only their order means something.
  std::vector<double> votes(const types::Features& view) const { return file_->votes(view); }

 private:
  void fill(std::size_t places, std::size_t most, const Source& source);

  std::optional<PlaceFile> file_, next_;
  std::size_t filled_ = 0;        // places of the map that are in the next one
  std::set<std::size_t> unkept_;  // places whose words are not beside the map; all when these are not either
  bool wordsKept_ = false;
  bool settled_ = false;
  std::size_t learnAt_;               // places at which words are learnt
  std::future<PlaceWords> learning_;  // the words of the next one,
  std::size_t takeAt_ = 0;            // and places at which they are taken
};

}  // namespace engram::pipeline
