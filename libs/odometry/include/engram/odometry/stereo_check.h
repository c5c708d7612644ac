// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/stereo.h"

#include <cstdint>
#include <memory>
#include <string>

namespace engram::odometry {

enum class StereoFault : std::uint8_t {
  kNone,
  kUnknown,     ///< too little was seen to tell
  kLeftBlank,   ///< the left eye shows nothing while the right one does: covered, unplugged
  kRightBlank,  ///< the other way round
  kSwapped,     ///< left and right are exchanged: the points have negative disparities
  kRightLate,   ///< the right image belongs to the left one of a frame before
  kRightEarly,  ///< the right image belongs to the left one of a frame later
  kRows,        ///< points lie in different rows: not rectified, or by a wrong calibration
};

const char* toString(StereoFault fault);

/// How many matches of left with right images have their points in one row, at a disparity that is possible.
struct RowAgreement {
  int matches = 0;
  int agree = 0;
  double share() const { return matches > 0 ? static_cast<double>(agree) / matches : 0.0; }
};

/// What a running check has found so far.
struct StereoHealth {
  StereoFault fault = StereoFault::kUnknown;
  int pairs = 0;                      ///< looked at
  int leftBlank = 0, rightBlank = 0;  ///< of these, where only the other eye shows something
  RowAgreement level;                 ///< images of one frame
  RowAgreement together;              ///< the same, but for an offset that all rows have: `rowOffset`
  RowAgreement swapped;               ///< the same, with negative disparities
  RowAgreement late, early;           ///< right images with the left ones of the frame before, after; so too
  int negative = 0;                   ///< of the matches `together`, with a negative disparity in any row
  double rowError = 0;                ///< median distance of the rows of images of one frame [px]
  double rowOffset = 0;  ///< median of how much higher points lie in the right image than in the left [px]

  bool ok() const { return fault == StereoFault::kNone; }
};

/// For the user: what is wrong and what to do. Empty for kNone and kUnknown.
std::string describe(const StereoHealth& health);

/// Watches rectified pairs for faults that no calibration shows: an eye that is covered, eyes that are
/// swapped or out of step, images that are not rectified. Corners of both eyes are matched by normalised
/// correlation in a window that reaches beyond their rows and to negative disparities; where a fault is, the
/// matches say which.
class StereoCheck {
 public:
  /// @param every looks at two consecutive pairs out of so many, at least 2.
  explicit StereoCheck(int every = 10);
  ~StereoCheck();
  StereoCheck(StereoCheck&&) noexcept;
  StereoCheck& operator=(StereoCheck&&) noexcept;

  /// All pairs of a drive, in their order.
  void add(const types::StereoPair& pair);
  StereoHealth health() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace engram::odometry
