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
  /// A frame has arrived whole.
  /// @param number as GigE Vision has it: 16 bit, after 65535 comes 1 (some cameras: 0); or 64 bit
  /// @return frames that were lost without a trace since the whole one before
  std::size_t whole(std::uint64_t number);
  /// A frame has arrived with packets missing. Its number is not to be trusted: the first packet, which holds
  /// it, may be one of them.
  void incomplete();

  /// The camera was started anew, its numbers begin anywhere.
  void restart() { last_.reset(); }

  std::size_t wholeFrames() const { return whole_; }
  std::size_t incompleteFrames() const { return incomplete_; }
  std::size_t missed() const { return missed_; }  ///< not one packet came, or there was no buffer for them

 private:
  std::optional<std::uint64_t> last_;  // number of the last whole frame
  std::size_t incompleteSince_ = 0;
  std::size_t whole_ = 0, incomplete_ = 0, missed_ = 0;
};

}  // namespace engram::capture
