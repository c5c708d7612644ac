// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/evaluation/truth.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string>

namespace engram::evaluation {

/// Whether a truth tells of the images that it is held against. One of another drive, or of images that go by
/// other names, judges nothing or everything wrong, without a word.
class TruthMatch {
 public:
  /// An image of the run.
  void addImage(const Truth& truth, const FrameRef& image);
  /// An image that made a place before the run: the truth may name it too.
  void addPlace(const Truth& truth, const FrameRef& place);

  /// Why the truth cannot be that of the run; empty when it can. It is refused when it has nothing to say of
  /// any image, or when less than half of what it holds occurs in the run and it speaks of less than half of
  /// the images. Empty without images.
  std::string problem(const Truth& truth) const;

  /// What was taken for granted: that images without file names are counted. Else empty.
  std::string notice(const Truth& truth) const;

 private:
  std::size_t occurring(const Truth& truth) const;

  std::size_t images_ = 0, spokenOf_ = 0, unnamed_ = 0;
  std::string unnamedLabel_;
  std::set<std::int64_t> keys_;  ///< of the truth, that occurred
  double firstStamp_ = std::numeric_limits<double>::infinity();
  double lastStamp_ = -std::numeric_limits<double>::infinity();
};

}  // namespace engram::evaluation
