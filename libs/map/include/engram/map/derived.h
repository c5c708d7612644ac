// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace engram::map {

/// What is worked out of a map, takes long to make, and is therefore kept beside it.
enum class DerivedKind : std::uint8_t {
  kWords = 'W',       ///< the words of an index of places; number 0
  kPlaceWords = 'I',  ///< those of one place, by its number: of its memory
  kSignature = 'A',   ///< what a whole image looks like, by the number of its view
};

struct DerivedRow {
  DerivedKind kind = DerivedKind::kWords;
  std::uint32_t id = 0;
  std::vector<std::uint8_t> data;  ///< of the kind's own layout, its version first
};

/// Reads what is kept beside a map. It is never the truth: rows that are damaged, or whose memory or view has
/// changed since, are as good as missing, and who wants them makes them anew.
class Derived {
 public:
  virtual ~Derived() = default;

  using Take = std::function<void(std::uint32_t id, std::span<const std::uint8_t> data)>;
  /// Hands over the rows of a kind that hold good, by rising number.
  virtual void read(DerivedKind kind, const Take& take) const = 0;
};

}  // namespace engram::map
