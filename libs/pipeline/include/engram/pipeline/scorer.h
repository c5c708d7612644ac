// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"
#include "engram/pipeline/params.h"
#include "engram/types/features.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace engram::pipeline {

/// How much a view looks like each place, by descriptors alone. Holds what it needs of every place; the
/// recogniser tells it of every change.
class Scorer {
 public:
  virtual ~Scorer() = default;

  /// Takes over a whole map, whose places these are, by index. To be called before anything else, or never.
  virtual void load(const map::TopologicalMap& map, std::span<const base::PlaceId> ids) {
    for (std::size_t i = 0; i < ids.size(); ++i) placeChanged(i, map.place(ids[i]));
    settled(map);
  }
  /// What is to be laid beside the map, so that load() finds it.
  virtual std::vector<map::DerivedRow> changes() { return {}; }

  /// A place was added (its index is then the number of places so far), or its memory has changed.
  virtual void placeChanged(std::size_t index, const map::Place& place) = 0;

  /// All changes of the map were told; the first time, all places that it has had from the start.
  virtual void settled(const map::TopologicalMap& /*map*/) {}

  /// One score in [0, 1] for each place, by index. The result does not depend on the number of threads.
  /// @param likely places that are to be looked at closely, whatever they look like at first sight
  virtual std::vector<double> scores(const types::Features& view,
                                     std::span<const std::size_t> likely) const = 0;
  std::vector<double> scores(const types::Features& view) const { return scores(view, {}); }
};

/// By `[recognise] scorer`:
/// - `ltm_match`: F eq (8), ratio-test matches over long-term features, every place by itself. In a map of
///   more than `exhaustive_places` an inverted file proposes `proposals` places for it. Others get scores
///   that are spread as those of a sample of them, so that evidence stands out of the same background;
/// - `matched_points`: the same matches by their number, over that of the view's features, whatever the place
///   remembers: the place with most of them looks most alike (D-03);
/// - `tfidf_incremental`: votes of the words of the incremental dictionary, over the largest
///   possible vote. The words of a place are those of its long-term features. The dictionary is no part of a
///   map file: it is made from the places in the order of their ids, so equal maps give equal answers. With
///   `rescore` > 0 that many places, those with the most votes, get the score of `ltm_match`, and all others
///   the smallest of these;
/// - `vocabulary_tree`: votes of the words of a vocabulary tree (K-14), over the largest vote for this view.
///   The tree is read from `[views] vocabulary`, or trained on the places that are loaded. A map that begins
///   empty trains one when it has `[views] train_after` places; until then all are matched.
std::unique_ptr<Scorer> makeScorer(const PipelineParams& params);

}  // namespace engram::pipeline
