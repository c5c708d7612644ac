// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/features.h"

#include <cstddef>
#include <memory>
#include <span>

namespace engram::features {

/// Descriptors laid out for the kernels of match(), to look for the nearest of one set for many of another.
class RowSet {
 public:
  /// @param descriptors kFloat ones are quantised
  explicit RowSet(const types::Descriptors& descriptors);
  ~RowSet();
  RowSet(RowSet&&) noexcept;
  RowSet& operator=(RowSet&&) noexcept;

  std::size_t size() const;

  /// For rows `begin` … `begin + out.size() - 1` of `queries` the number of the nearest row of this set
  /// (ties: the lower); -1 when it is empty. The same on every processor.
  /// @throws std::invalid_argument when the descriptors are of another kind or dimension.
  void nearest(const RowSet& queries, std::size_t begin, std::span<int> out) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace engram::features
