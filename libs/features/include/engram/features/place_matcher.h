// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/features/matching.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace engram::features {

/// Matches one image against the features of many places. It keeps a copy of their descriptors, quantised and
/// laid out for the kernels; float descriptors become kInt8.
///
/// Each place is matched by itself: nearest and second nearest come from that place alone, as if match() were
/// called with it. Places that look alike therefore do not suppress each other's matches.
class PlaceMatcher {
 public:
  PlaceMatcher();
  ~PlaceMatcher();
  PlaceMatcher(PlaceMatcher&&) noexcept;
  PlaceMatcher& operator=(PlaceMatcher&&) noexcept;

  /// Adds a place or replaces its features. Indices need not be dense; those between are empty.
  /// @throws std::invalid_argument when the descriptors differ in kind or dimension from those held.
  void set(std::size_t place, const types::Features& features);
  /// Empties a place; its index remains and counts 0.
  void remove(std::size_t place);
  /// One more than the highest index ever set.
  std::size_t size() const;

  /// For each place the number of matches, equal to match(quantised query, quantised place).size().
  std::vector<int> ratioMatchCounts(const types::Features& query, const MatchParams& params,
                                    int threads = 1) const;

  /// The same for these places alone, in their order.
  /// @throws std::invalid_argument when there is no such place.
  std::vector<int> ratioMatchCounts(const types::Features& query, std::span<const std::size_t> places,
                                    const MatchParams& params, int threads = 1) const;

  /// The matches with one place; a = feature of `query`, b = feature of the place.
  std::vector<types::Match> matches(const types::Features& query, std::size_t place,
                                    const MatchParams& params) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace engram::features
