// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/scan_filter.h"

#include "engram/base/error.h"
#include "engram/posegraph/gating.h"

#include <Eigen/Cholesky>

#include <algorithm>

namespace engram::posegraph {
namespace {

using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 6, 1>;

constexpr double kHeld = 1e-12;  // variance of what is not free [m²] and [rad²]

const std::vector<int>& freeIn(bool planar) {
  static const std::vector<int> kPlane{0, 1, 5}, kSpace{0, 1, 2, 3, 4, 5};
  return planar ? kPlane : kSpace;
}

Small freePart(const types::Matrix6d& m, bool planar) { return m(freeIn(planar), freeIn(planar)); }

SmallVector freePart(const types::Vector6d& v, bool planar) { return v(freeIn(planar)); }

types::Vector6d inSpace(const SmallVector& d, bool planar) {
  types::Vector6d v = types::Vector6d::Zero();
  v(freeIn(planar)) = d;
  return v;
}

types::Matrix6d inSpace(const Small& cov, bool planar) {
  types::Matrix6d m = types::Matrix6d::Identity() * kHeld;
  m(freeIn(planar), freeIn(planar)) = cov;
  return types::symmetric(m);
}

/// A planar robot turns about the vertical alone.
Eigen::Isometry3d inPlane(const Eigen::Isometry3d& T, bool planar) {
  if (!planar) return types::rigid(T);
  Eigen::Isometry3d flat = Eigen::Isometry3d::Identity();
  flat.linear() =
      Eigen::AngleAxisd(std::atan2(T(1, 0), T(0, 0)), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  flat.translation().head<2>() = T.translation().head<2>();
  return flat;
}

}  // namespace

ScanFilter::ScanFilter(bool planar, const std::map<PlaceId, Eigen::Isometry3d>& T_map,
                       const Eigen::MatrixXd& cov)
    : planar_(planar), P_(cov) {
  for (const auto& [name, T] : T_map) states_.push_back({name, inPlane(T, planar)});
  const auto n = static_cast<Eigen::Index>(states_.size()) * dof();
  if (cov.rows() != n || cov.cols() != n || !cov.allFinite() || !cov.isApprox(cov.transpose(), 1e-9) ||
      (n > 0 && Eigen::LLT<Eigen::MatrixXd>(cov).info() != Eigen::Success))
    throw base::Error("the covariance of the reference scans is not that of " + std::to_string(T_map.size()) +
                      " poses");
}

void ScanFilter::start(const Eigen::Isometry3d& T_map_robot, double sigma) {
  lose();
  robot_ = append({{}, inPlane(T_map_robot, planar_)});
  const auto r = static_cast<Eigen::Index>(*robot_) * dof();
  P_.block(r, r, dof(), dof()) = Eigen::MatrixXd::Identity(dof(), dof()) * sigma * sigma;
}

/// V says nothing of it. The error of the robot is that of the reference and that of the measurement.
void ScanFilter::relocate(PlaceId reference, const types::RelPose& T_reference_robot) {
  if (!reference.valid()) throw base::Error("a robot is found by a reference scan alone");
  lose();
  const std::size_t a = indexOf(reference);
  const Eigen::Isometry3d T = inPlane(states_[a].T_map * T_reference_robot.T_a_b, planar_);
  robot_ = append({{}, T});
  copyErrors(a, *robot_);
  const auto r = static_cast<Eigen::Index>(*robot_) * dof();
  P_.block(r, r, dof(), dof()) += freePart(types::transported(T_reference_robot.cov, adjoint(T)), planar_);
}

void ScanFilter::lose() {
  std::vector<std::size_t> references;
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (states_[i].name.valid()) references.push_back(i);
  keep(references);
  robot_.reset();
  previous_.reset();
}

void ScanFilter::predict(const types::RelPose& T_last_now) {
  if (!robot_) throw base::Error("a robot whose pose is unknown cannot be predicted");
  if (!previous_) previous_ = append({});
  states_[*previous_].T_map = states_[*robot_].T_map;
  copyErrors(*robot_, *previous_);
  Eigen::Isometry3d& T = states_[*robot_].T_map;
  T = inPlane(T * T_last_now.T_a_b, planar_);
  const auto r = static_cast<Eigen::Index>(*robot_) * dof();
  P_.block(r, r, dof(), dof()) += freePart(types::transported(T_last_now.cov, adjoint(T)), planar_);
}

void ScanFilter::promote(PlaceId name) {
  const bool taken =
      std::any_of(states_.begin(), states_.end(), [&](const auto& s) { return s.name == name; });
  if (!previous_ || !name.valid() || taken) throw base::Error("no scan can become this reference");
  states_[*previous_].name = name;
  previous_.reset();
}

/// With A = adjoint(T_map_robot^-1) the innovation is r = A (d_robot - d_from) + noise.
ScanFilter::Update ScanFilter::measure(PlaceId from, const types::RelPose& T_from_robot, double probability) {
  const auto a = static_cast<Eigen::Index>(indexOf(from)) * dof();
  const auto b = static_cast<Eigen::Index>(*robot_) * dof();
  const Eigen::Isometry3d& T_map_robot = states_[*robot_].T_map;
  const Eigen::Isometry3d expected = states_[indexOf(from)].T_map.inverse() * T_map_robot;
  const SmallVector r = freePart(logSe3(expected.inverse() * T_from_robot.T_a_b), planar_);
  const Small A = freePart(adjoint(T_map_robot.inverse()), planar_), R = freePart(T_from_robot.cov, planar_);

  const auto timesHt = [&](const Eigen::MatrixXd& M) -> Eigen::MatrixXd {
    return (M.middleCols(b, dof()) - M.middleCols(a, dof())) * A.transpose();
  };
  const Eigen::MatrixXd PHt = timesHt(P_);
  const Small S = A * (PHt.middleRows(b, dof()) - PHt.middleRows(a, dof())) + R;
  const Eigen::LDLT<Small> factor(S);
  Update update{false, r.dot(factor.solve(r))};
  update.accepted = update.chi2 <= chi2Bound(probability, dof());
  if (!update.accepted) return update;

  const Eigen::MatrixXd K = factor.solve(PHt.transpose()).transpose();
  P_.noalias() -= K * PHt.transpose();  // (I - K H) P, then Joseph: times (I - K H)^T, and K R K^T
  const Eigen::MatrixXd rest = K * R - timesHt(P_);
  P_.noalias() += rest * K.transpose();
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  const Eigen::VectorXd step = K * r;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const SmallVector d = step.segment(static_cast<Eigen::Index>(i) * dof(), dof());
    states_[i].T_map = inPlane(expSe3(inSpace(d, planar_)) * states_[i].T_map, planar_);
  }
  return update;
}

const Eigen::Isometry3d& ScanFilter::T_map_robot() const {
  if (!robot_) throw base::Error("where the robot is, is not known");
  return states_[*robot_].T_map;
}

const Eigen::Isometry3d& ScanFilter::T_map_previous() const {
  if (!previous_) throw base::Error("there is no scan before");
  return states_[*previous_].T_map;
}

std::map<PlaceId, Eigen::Isometry3d> ScanFilter::references() const {
  std::map<PlaceId, Eigen::Isometry3d> T_map;
  for (const State& s : states_)
    if (s.name.valid()) T_map[s.name] = s.T_map;
  return T_map;
}

types::RelPose ScanFilter::relative(PlaceId from) const {
  const std::size_t a = indexOf(from);
  const Eigen::Isometry3d& T = T_map_robot();
  const Eigen::MatrixXd P = of({a, *robot_});
  const Eigen::MatrixXd difference = P.topLeftCorner(dof(), dof()) + P.bottomRightCorner(dof(), dof()) -
                                     P.topRightCorner(dof(), dof()) - P.bottomLeftCorner(dof(), dof());
  const Small A = freePart(adjoint(T.inverse()), planar_);
  return {.T_a_b = states_[a].T_map.inverse() * T,
          .cov = inSpace(Small(A * difference * A.transpose()), planar_)};
}

Eigen::MatrixXd ScanFilter::robotCovariance() const {
  T_map_robot();
  return of({*robot_});
}

Eigen::MatrixXd ScanFilter::covariance() const { return of(byName()); }

std::size_t ScanFilter::indexOf(PlaceId from) const {
  if (!from.valid() && previous_) return *previous_;
  for (std::size_t i = 0; from.valid() && i < states_.size(); ++i)
    if (states_[i].name == from) return i;
  throw base::Error(from.valid() ? "scan " + std::to_string(from.value) + " is no reference"
                                 : "there is no scan before");
}

/// Its errors are to be written yet.
std::size_t ScanFilter::append(const State& state) {
  states_.push_back(state);
  const auto n = static_cast<Eigen::Index>(states_.size()) * dof();
  P_.conservativeResize(n, n);
  P_.rightCols(dof()).setZero();
  P_.bottomRows(dof()).setZero();
  return states_.size() - 1;
}

/// `to` errs as `from` does.
void ScanFilter::copyErrors(std::size_t from, std::size_t to) {
  const auto a = static_cast<Eigen::Index>(from) * dof(), b = static_cast<Eigen::Index>(to) * dof();
  P_.middleCols(b, dof()) = P_.middleCols(a, dof()).eval();
  P_.middleRows(b, dof()) = P_.middleRows(a, dof()).eval();
}

void ScanFilter::keep(const std::vector<std::size_t>& states) {
  P_ = of(states);
  std::vector<State> kept;
  for (const std::size_t i : states) kept.push_back(states_[i]);
  states_ = std::move(kept);
}

Eigen::MatrixXd ScanFilter::of(const std::vector<std::size_t>& states) const {
  std::vector<Eigen::Index> rows;
  for (const std::size_t i : states)
    for (int k = 0; k < dof(); ++k) rows.push_back(static_cast<Eigen::Index>(i) * dof() + k);
  return P_(rows, rows);
}

std::vector<std::size_t> ScanFilter::byName() const {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (states_[i].name.valid()) order.push_back(i);
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return states_[i].name < states_[j].name; });
  return order;
}

Eigen::MatrixXd jointCovariance(const Graph& graph, bool planar, double sigma) {
  const auto dof = static_cast<Eigen::Index>(freeIn(planar).size());
  std::map<PlaceId, Eigen::Index> at;
  for (const auto& [id, T] : graph.poses) at.emplace(id, static_cast<Eigen::Index>(at.size()) * dof);
  const auto n = static_cast<Eigen::Index>(at.size()) * dof;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  // What no constraint reaches is known as badly as can be told apart from it.
  constexpr double kNothing = 1e-8;  // [1/m²] and [1/rad²]
  information.diagonal().setConstant(kNothing);
  if (n > 0) information.diagonal().head(dof).setConstant(1 / (sigma * sigma));
  for (const Constraint& c : graph.constraints) {
    if (!c.T_a_b.hasScale) continue;
    const Small A = freePart(adjoint(graph.poses.at(c.b).inverse()), planar);
    const Small W = A.transpose() * freePart(c.T_a_b.cov, planar).ldlt().solve(A);
    const Eigen::Index a = at.at(c.a), b = at.at(c.b);
    information.block(a, a, dof, dof) += W;
    information.block(b, b, dof, dof) += W;
    information.block(a, b, dof, dof) -= W;
    information.block(b, a, dof, dof) -= W;
  }
  const Eigen::MatrixXd cov = information.llt().solve(Eigen::MatrixXd::Identity(n, n));
  return 0.5 * (cov + cov.transpose());
}

Eigen::Matrix2d positionCovariance(const Eigen::MatrixXd& cov, const Eigen::Isometry3d& T_map) {
  types::Matrix6d all = types::Matrix6d::Zero();
  const auto& free = freeIn(cov.rows() == 3);
  all(free, free) = cov;
  Eigen::Matrix<double, 3, 6> J;
  J << Eigen::Matrix3d::Identity(), -types::skew(T_map.translation());
  return (J * all * J.transpose()).topLeftCorner<2, 2>();
}

}  // namespace engram::posegraph
