// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/posegraph/graph.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace engram::posegraph {

/// The augmented-state Kalman filter of reference scans (V-09, V eq (5) to (8): Bertolli, Jensfelt &
/// Christensen 2006): poses of the robot, of the scan before, and of all reference scans, with their joint
/// covariance. The scan before becomes a reference by another name; no number moves.
///
/// V says neither how poses err nor how they are gated (V-E5). Errors here are small motions of the map
/// frame: T_true = exp(d) T_map_x, d = (translation [m], rotation vector [rad]). What a measured relative
/// pose says of them is then the difference of two errors, wherever the filter is linearised: it never learns
/// where the whole map is, which no such measurement tells. Joseph's form keeps the covariance symmetric and
/// positive definite. Time and memory of an update grow with the square of the references (V-12).
class ScanFilter {
 public:
  /// @param planar only x, y and yaw are free
  explicit ScanFilter(bool planar = true) : planar_(planar) {}
  /// References of a map that was made before; the robot is at an unknown place of it.
  /// @param T_map by id @param cov joint covariance in the order of the ids, `dof()` rows each
  /// Throws base::Error for a covariance of another size, or one that is not positive definite.
  ScanFilter(bool planar, const std::map<PlaceId, Eigen::Isometry3d>& T_map, const Eigen::MatrixXd& cov);

  int dof() const { return planar_ ? 3 : 6; }
  bool planar() const { return planar_; }

  /// The robot begins a map here. @param sigma of the whole map, which nothing measures [m] and [rad]
  void start(const Eigen::Isometry3d& T_map_robot, double sigma = 1e-3);
  /// The robot is where this reference sees it, whatever was believed before; there is no scan before.
  void relocate(PlaceId reference, const types::RelPose& T_reference_robot);
  /// Nobody knows where the robot is; there is no scan before.
  void lose();
  bool located() const { return robot_.has_value(); }

  /// One step on: where the robot was is where the scan before was taken. The robot must be located().
  void predict(const types::RelPose& T_last_now);
  /// Whether there is a scan before that is no reference.
  bool hasPrevious() const { return previous_.has_value(); }
  /// The scan before becomes a reference, under this name (V-08). Throws base::Error without one, or when the
  /// name is taken.
  void promote(PlaceId name);

  /// What became of a measurement.
  struct Update {
    bool accepted = false;
    double chi2 = 0;  ///< of the innovation, dof() degrees of freedom
  };
  /// The pose of the robot seen from a reference; `PlaceId()`: from the scan before. It counts unless the
  /// innovation is larger than that of a share `probability` of true ones.
  Update measure(PlaceId from, const types::RelPose& T_from_robot, double probability);

  /// Throw base::Error for what is not in the state.
  const Eigen::Isometry3d& T_map_robot() const;
  const Eigen::Isometry3d& T_map_previous() const;
  std::map<PlaceId, Eigen::Isometry3d> references() const;
  /// As expected before it is measured, with covariance; `from` as in measure(). What is not free has a
  /// variance of next to nothing.
  types::RelPose relative(PlaceId from) const;
  /// Of the robot, and of references in the order of their ids: errors of the map frame.
  Eigen::MatrixXd robotCovariance() const;
  Eigen::MatrixXd covariance() const;

 private:
  struct State {
    PlaceId name;  // invalid: no reference
    Eigen::Isometry3d T_map = Eigen::Isometry3d::Identity();
  };
  std::size_t indexOf(PlaceId from) const;
  std::size_t append(const State& state);
  void copyErrors(std::size_t from, std::size_t to);
  void keep(const std::vector<std::size_t>& states);
  Eigen::MatrixXd of(const std::vector<std::size_t>& states) const;
  std::vector<std::size_t> byName() const;

  bool planar_;
  std::vector<State> states_;
  std::optional<std::size_t> robot_, previous_;
  Eigen::MatrixXd P_;
};

/// The joint covariance of all poses that the constraints of a graph give, in the order of the ids, in the
/// convention of ScanFilter: the inverse of their information at the current poses. The first place is held
/// by `sigma` [m] and [rad]; what no constraint with scale joins to it may be anywhere (10 km). For a map
/// that was made without the filter. Takes the cube of the number of places.
Eigen::MatrixXd jointCovariance(const Graph& graph, bool planar, double sigma = 1e-3);

/// Covariance of the position of a pose in the map, in the plane [m²], from a covariance of its error: what
/// an ellipse shows.
Eigen::Matrix2d positionCovariance(const Eigen::MatrixXd& cov, const Eigen::Isometry3d& T_map);

}  // namespace engram::posegraph
