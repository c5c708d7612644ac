// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/features/place_matcher.h"
#include "engram/map/topological_map.h"
#include "engram/pipeline/params.h"
#include "engram/types/features.h"
#include "engram/vocabulary/view_index.h"

#include <cstddef>
#include <future>
#include <map>
#include <optional>
#include <vector>

namespace engram::pipeline {

/// Which places or views of a map look like an image: by a vocabulary tree (K-14), and by matching with all
/// of them as long as there is none. Without a file a tree is trained on the map itself, in the background.
/// It is taken into use at a number of views that does not depend on how long that took: equal drives give
/// equal maps.
class TreeSearch {
 public:
  /// Views are searched by all their features, places by those of long-term memory. The tree of places that
  /// are loaded is there at once: localising may add none.
  enum class Of { kViews, kPlaces };
  /// Throws base::Error for a vocabulary file that cannot be used.
  explicit TreeSearch(const PipelineParams& params, Of of = Of::kViews);

  void load(const map::TopologicalMap& map);
  /// Takes over the views that have come and gone since.
  void follow(const map::TopologicalMap& map);

  struct Found {
    base::PlaceId view;
    double score = 0;  ///< of the words, or matches by descriptor
  };
  /// The views that look most like an image, best first; at most `[views] candidates` times `share`.
  std::vector<Found> find(const types::Features& image, int share = 1) const;

  /// Whether a vocabulary tree is in use.
  bool hasTree() const { return index_.has_value(); }

 private:
  void add(const map::TopologicalMap& map, base::PlaceId view);
  void remove(base::PlaceId view);
  /// What is searched of a place; `room` holds it where it is a part of the memory.
  const types::Features& featuresOf(const map::Place& place, types::Features& room) const;
  /// Draws what a tree is trained on.
  types::Descriptors sampleOf(const map::TopologicalMap& map) const;
  std::size_t grown(const map::TopologicalMap& map) const;
  void startTraining(const map::TopologicalMap& map);
  void takeTree(const map::TopologicalMap& map);

  Of of_;
  ViewParams params_;
  vocabulary::TreeParams treeParams_;
  features::MatchParams match_;
  int threads_;
  map::Cursor read_;

  std::optional<vocabulary::ViewIndex> index_;  // its views have the numbers of the places
  features::PlaceMatcher matcher_;              // while there is no index
  std::vector<base::PlaceId> slots_;            // of the matcher
  std::map<base::PlaceId, std::size_t> slotOf_;

  std::future<vocabulary::VocabularyTree> training_;
  std::size_t takeAt_ = 0;   // views to come until the tree in training is taken into use
  std::size_t trainAt_ = 0;  // size of the map at which the next is trained; 0: never
};

}  // namespace engram::pipeline
