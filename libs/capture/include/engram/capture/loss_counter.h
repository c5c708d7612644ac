// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

namespace engram::capture {

/// Finds lost frames by the numbers that a camera gives them.
class LossCounter {
 public:
  /// A frame has arrived, whole or with packets missing.
  /// @param number as GigE Vision has it: 16 bit, after 65535 comes 1 (some cameras: 0); or 64 bit
  /// @return frames that were lost without a trace just before this one
  std::size_t arrived(std::uint64_t number, bool whole);

  /// The camera was started anew, its numbers begin anywhere.
  void restart() { last_.reset(); }

  std::size_t whole() const { return whole_; }
  std::size_t incomplete() const { return incomplete_; }  ///< arrived with packets missing
  std::size_t missed() const { return missed_; }          ///< not one packet, or no buffer for them

 private:
  std::optional<std::uint64_t> last_;
  std::size_t whole_ = 0, incomplete_ = 0, missed_ = 0;
};

}  // namespace engram::capture
