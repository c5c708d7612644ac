// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/ids.h"
#include "engram/vocabulary/kmeans_dictionary.h"

#include <optional>

namespace engram::vocabulary {

/// The bag-of-words baseline of F-27: remembered views as tf-idf vectors over a k-means dictionary that is
/// trained anew at every update of the map. Geometric verification of its answers (F-27b) is the caller's.
class BagOfWords {
 public:
  /// One remembered image.
  struct View {
    base::PlaceId place;
    const types::Descriptors* descriptors = nullptr;
  };

  /// @throws base::ConfigError when a parameter is out of range.
  explicit BagOfWords(const BowParams& params);

  /// Forgets all, trains a dictionary on these views and describes each by it. The descriptors are not kept.
  /// @throws base::Error as KMeansDictionary; views that are all empty are legal and match nothing.
  void rebuild(std::span<const View> views);

  std::size_t size() const { return places_.size(); }
  base::PlaceId placeOf(std::size_t view) const { return places_.at(view); }

  /// Cosine of the tf-idf vectors of the query and of each view, in [0, 1], in the order of rebuild().
  std::vector<double> score(const types::Descriptors& query) const;

  /// Memory of the dictionary and of the views' vectors [bytes]; F-29 compares it with the other memories.
  std::size_t bytes() const;

 private:
  BowParams params_;
  std::optional<KMeansDictionary> dictionary_;
  Eigen::VectorXd idf_;
  std::vector<Eigen::VectorXd> vectors_;  // of the views
  std::vector<base::PlaceId> places_;     // parallel
};

}  // namespace engram::vocabulary
