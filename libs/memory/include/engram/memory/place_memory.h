// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/features.h"
#include "engram/types/frame_report.h"
#include "engram/types/match.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace engram::memory {

enum class Stage : std::uint8_t { kShortTerm = 0, kLongTerm = 1 };

/// The state of one remembered feature.
struct FeatureState {
  std::uint32_t id = 0;   ///< unique within its place and never reused: edges refer to it
  float value = 0;        ///< accumulated votes, the FSH before normalisation (F-02)
  std::uint16_t age = 0;  ///< updates of the place since this feature was added (F-E5)
  /// State of the finite state machine of the two stores (D-04, D-05); for the FSH, updates in which the
  /// feature was seen again.
  std::uint16_t counter = 0;
  Stage stage = Stage::kShortTerm;
  std::vector<std::uint8_t>
      history;  ///< normalised FSH * 255 after each update, newest last: rfsh(i, p) of F-04
  bool operator==(const FeatureState&) const = default;
};

/// Everything a place remembers: the reference view, short-term and long-term features together (F-01).
/// Plain data: the models change it, the store writes it.
struct PlaceMemory {
  types::Features features;  ///< parallel to `states`; descriptors quantised
  std::vector<FeatureState> states;
  std::uint32_t updates = 0;  ///< views this memory has learnt from; 1 after the first
  std::uint32_t nextFeatureId = 0;

  /// Indices of the long-term features, ascending: the only ones that localisation sees (F-02).
  std::vector<int> longTerm() const;
};

struct Redetections;

/// How a place remembers and forgets. Pure: the same arguments give the same result.
class MemoryModel {
 public:
  virtual ~MemoryModel() = default;

  /// The memory of a place seen for the first time.
  virtual PlaceMemory start(const types::Features& view) const = 0;

  /// Learns from a further view of the place.
  /// @param matches verified correspondences, one-to-one: a = feature of `view`, b = feature of `memory`.
  virtual types::MemoryChange update(PlaceMemory& memory, const types::Features& view,
                                     std::span<const types::Match> matches) const = 0;

  /// update() within a map: a model that learns from re-detection over all places counts this view in `seen`
  /// and heeds it (F-31, D-12). The others leave it alone.
  virtual types::MemoryChange learn(PlaceMemory& memory, const types::Features& view,
                                    std::span<const types::Match> matches, Redetections& seen) const;
};

}  // namespace engram::memory
