// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/memory/place_memory.h"

namespace engram::memory {

/// Section `[multi_store]`.
struct MultiStoreParams {
  int stm_states = 2;         ///< a feature is promoted at its (stm_states + 1)-th sighting (D-05, D-E1)
  int ltm_states = 8;         ///< a long-term feature is forgotten after so many misses in a row (D-04)
  int ltm_min_features = 40;  ///< floor K_min of the long-term memory (D-E6): twice what acceptance needs
  double duplicate_distance = 0.1;  ///< descriptor distance; no insertion next to a feature so near (D-06)

  void describe(base::Params& p);
};

/// The short- and long-term stores of Dayoub & Duckett 2008 (D-01 to D-06).
///
/// A feature in the first state of either store has FeatureState::counter 1. FeatureState::value counts its
/// sightings. An update is recall (D-04: a long-term hit returns to the first state, a miss goes to the next
/// one, and out after the last), then rehearsal with what recall left over (D-05: a short-term hit goes to
/// the next state, and into long-term memory after the last; a miss in the first state goes out, in any other
/// back to the first). All new states follow from the old ones before any feature comes or goes (D-E2).
///
/// Counted so, a feature that is detected with probability 0.5 and was never seen before is promoted within 8
/// updates with probability 46.9 %, 21.9 % and 9.0 % for 2, 3 and 4 short-term states: the figures of F-E21.
class MultiStore : public MemoryModel {
 public:
  /// Throws base::ConfigError that names the key.
  explicit MultiStore(MultiStoreParams params);

  /// All features are long-term; short-term memory is empty (D-02).
  PlaceMemory start(const types::Features& view) const override;

  /// Where more features run out of states than the floor allows, those with the fewest misses in a row stay;
  /// of equal ones those with the most sightings, then the strongest. Their misses go on counting. A place
  /// whose first view was empty starts with this one. Throws as Fsh::update() does.
  types::MemoryChange update(PlaceMemory& memory, const types::Features& view,
                             std::span<const types::Match> matches) const override;

  const MultiStoreParams& params() const { return params_; }

 private:
  MultiStoreParams params_;
};

}  // namespace engram::memory
