// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/belief/adjacency.h"

#include <cstddef>
#include <span>
#include <vector>

namespace engram::belief {

/// What the last images say together of each place: the evidence along the best way through the map that ends
/// there, older images counting less. It is held against the same sums of all other places, so that images
/// that resemble one another, or much of the map, are no evidence by their number. Nothing is believed from
/// it about the time before.
class Sequence {
 public:
  /// @param images that count, about: the weight falls by 1 / images from one to the next
  explicit Sequence(int images) : images_(images) {}

  /// @param deviates of one image, one a place: how far each stands out, as standardised() says
  /// @param reach edges that the robot may have moved since the image before
  /// Throws std::invalid_argument when their number is not that of the places.
  void add(std::span<const double> deviates, const Adjacency& adjacency, int reach);
  void reset();

  /// Fewer images than were asked for say nothing.
  bool ready() const { return seen_ >= images_; }

  /// The place that stands out most.
  struct Peak {
    int place = -1;
    double deviates = 0;   ///< of its sum from those of all places, in units of their spread
    double rival = 0;      ///< the same of the best place that is not around it
    double log10Nfa = 0;   ///< places expected to stand out as far by accident, were the sums normal
    double lastImage = 0;  ///< deviates that the last image itself has around it
  };
  /// @param around edges within which places are not rivals. None without images: place is -1.
  Peak peak(const Adjacency& adjacency, int around) const;

 private:
  int images_;
  int seen_ = 0;
  std::vector<double> sums_, last_;
};

}  // namespace engram::belief
