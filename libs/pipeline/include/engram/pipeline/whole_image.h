// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/appearance/describer.h"
#include "engram/appearance/signature_index.h"
#include "engram/map/topological_map.h"

#include <map>
#include <memory>
#include <vector>

namespace engram::pipeline {

/// What whole images say of the places: those that the map keeps, made small, against that of the robot.
class WholeImage {
 public:
  /// @param describer must not be null
  explicit WholeImage(std::unique_ptr<appearance::Describer> describer)
      : describer_(std::move(describer)), index_(describer_->dim()) {}

  /// Takes over what lies beside a map, for add(); what is not needed is to be forgotten after it.
  void restore(const map::TopologicalMap& map);
  void forgetRestored() { restored_.clear(); }
  /// What was worked out of pictures since, to be laid beside the map.
  std::vector<map::DerivedRow> changes();

  /// A place is new, under this number. One without a picture, or with a broken one, is like nothing.
  void add(const map::TopologicalMap& map, base::PlaceId place, std::size_t index);

  /// In [0, 1], one a place. @param picture of the camera
  std::vector<double> similarities(const cv::Mat& picture) const;

 private:
  std::unique_ptr<appearance::Describer> describer_;
  appearance::SignatureIndex index_;
  std::map<base::ViewId, Eigen::VectorXf> restored_;
  std::map<base::ViewId, std::size_t> unkept_;  // by what view it was made, the number of the place
};

}  // namespace engram::pipeline
