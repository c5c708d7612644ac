// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <limits>

namespace engram::base {

/// An index that cannot be mixed up with one of another kind. Default constructed it is invalid.
template <class Tag>
struct StrongId {
  static constexpr std::uint32_t kInvalid = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t value = kInvalid;

  constexpr StrongId() = default;
  constexpr explicit StrongId(std::uint32_t v) : value(v) {}
  constexpr bool valid() const { return value != kInvalid; }
  constexpr auto operator<=>(const StrongId&) const = default;
};

using PlaceId = StrongId<struct PlaceTag>;
using ViewId = StrongId<struct ViewTag>;
using EdgeId = StrongId<struct EdgeTag>;
using WordId = StrongId<struct WordTag>;

}  // namespace engram::base

template <class Tag>
struct std::hash<engram::base::StrongId<Tag>> {
  std::size_t operator()(engram::base::StrongId<Tag> id) const noexcept {
    return std::hash<std::uint32_t>{}(id.value);
  }
};
