// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/appearance/describer.h"
#include "engram/appearance/signature_index.h"
#include "engram/map/topological_map.h"

#include <memory>
#include <vector>

namespace engram::pipeline {

/// What whole images say of the places: those that the map keeps, made small, against that of the robot.
class WholeImage {
 public:
  /// @param describer must not be null
  explicit WholeImage(std::unique_ptr<appearance::Describer> describer)
      : describer_(std::move(describer)), index_(describer_->dim()) {}

  /// A place is new, under this number. One without a picture, or with a broken one, is like nothing.
  void add(const map::TopologicalMap& map, base::PlaceId place, std::size_t index);

  /// In [0, 1], one a place. @param picture of the camera
  std::vector<double> similarities(const cv::Mat& picture) const;

 private:
  std::unique_ptr<appearance::Describer> describer_;
  appearance::SignatureIndex index_;
};

}  // namespace engram::pipeline
