// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/frame.h"

#include <optional>
#include <string>

namespace engram::sources {

/// A stream of frames in order of time.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// The next frame; none at the end. After the end, problem() tells whether it was a clean one.
  virtual std::optional<types::Frame> next() = 0;

  /// Share of the input read, in [0, 1]; negative when unknown.
  virtual double progress() const = 0;

  /// Empty after a clean end; else why the source ended early or what was left out, as a message for the user
  /// (for example a truncated file). Everything before the damage has been delivered by then.
  virtual std::string problem() const = 0;
};

}  // namespace engram::sources
