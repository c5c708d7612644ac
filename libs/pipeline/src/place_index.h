// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/features.h"
#include "place_file.h"
#include "place_words.h"

#include <cstddef>
#include <functional>
#include <future>
#include <optional>
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

  /// @param from as many places need no index
  explicit PlaceIndex(std::size_t from) : learnAt_(from + 1) {}

  /// Whether it can be asked.
  bool ready() const { return file_.has_value(); }

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
  std::size_t filled_ = 0;  // places of the map that are in the next one
  bool settled_ = false;
  std::size_t learnAt_;               // places at which words are learnt
  std::future<PlaceWords> learning_;  // the words of the next one,
  std::size_t takeAt_ = 0;            // and places at which they are taken
};

}  // namespace engram::pipeline
