// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/frame.h"

#include <cstdint>
#include <string>

namespace engram::store {

/// One run that wrote into a map: a drive that was mapped, or that taught places while localising.
struct Drive {
  std::uint32_t id = 0;           ///< number in the map, from 0 in the order of the runs
  int session = -1;               ///< number of its path in the map; negative when it only taught places
  std::string source{};           ///< file name of the rawlog, or name of the live camera
  std::uint32_t fingerprint = 0;  ///< of the first image: fingerprintOf()
  double firstStamp = 0, lastStamp = 0;  ///< [s] of its images; they need not rise
  std::uint64_t firstRecord = 0;         ///< number of its first record in the map
  std::uint64_t images = 0;              ///< that were committed
  bool finished = false;                 ///< false while it goes on, and for ever when it was cut off
  bool operator==(const Drive&) const = default;
};

/// CRC-32 of the stamp and pixels of an image: tells whether a drive begins like another one.
std::uint32_t fingerprintOf(const types::Frame& first);

/// "drive 2 ('monday.rawlog', 120 images)"
std::string describe(const Drive& drive);

}  // namespace engram::store
