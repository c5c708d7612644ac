// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "uncertainty.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace engram::posegraph {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// The length of an edge for the search: what it adds to the position, and its turn over a few metres.
double searchVariance(const Constraint& c, bool planar) {
  if (!c.T_a_b.hasScale) return kNever;
  constexpr double kMetresPerRadian = 3;
  const auto v = c.T_a_b.cov.diagonal();
  const double turn = planar ? v[5] : v[3] + v[4] + v[5];
  return v[0] + v[1] + (planar ? 0 : v[2]) + kMetresPerRadian * kMetresPerRadian * turn;
}

}  // namespace

Test testGap(const Eigen::Matrix<double, 6, 1>& gap, const types::Matrix6d& known,
             const types::Matrix6d& measured, bool planar) {
  static const std::vector<int> kPlane{0, 1, 5};
  Test test;
  if (planar) {
    const Eigen::Vector3d flat = gap(kPlane);
    const Eigen::Matrix3d S = (known + measured)(kPlane, kPlane);
    test.chi2 = flat.dot(S.ldlt().solve(flat));
    const double half = (known(0, 0) + known(1, 1)) / 2;
    test.sigma = std::sqrt(std::max(0.0, half + std::hypot((known(0, 0) - known(1, 1)) / 2, known(0, 1))));
    test.sigmaYaw = std::sqrt(std::max(0.0, known(5, 5)));
    return test;
  }
  test.chi2 = gap.dot((known + measured).ldlt().solve(gap));
  using Solver = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>;
  const auto largest = [&](const Eigen::Matrix3d& m) {
    return std::sqrt(std::max(0.0, Solver(m, Eigen::EigenvaluesOnly).eigenvalues()[2]));
  };
  test.sigma = largest(known.topLeftCorner<3, 3>());
  test.sigmaYaw = largest(known.bottomRightCorner<3, 3>());
  return test;
}

TrustedTree::TrustedTree(const Graph& trusted, bool planar) : index_(trusted) {
  const std::size_t n = index_.size();
  order_.assign(n, 0);
  root_.assign(n, kNone);
  depth_.assign(n, 0);
  up_.resize(n);
  T_root_.assign(n, Eigen::Isometry3d::Identity());
  P_.assign(n, types::Matrix6d::Zero());
  std::vector<std::vector<std::uint32_t>> children(n);
  // Prim's tree: of all trees it has the least of the largest variances.
  using Item =
      std::tuple<double, std::uint32_t, std::uint32_t, std::uint32_t>;  // variance, child, parent, edge
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
  const auto push = [&](std::uint32_t from) {
    for (const auto& arm : index_.arms(from)) {
      const double v = searchVariance(trusted.constraints[arm.constraint], planar);
      if (root_[arm.to] == kNone && v < kNever) queue.emplace(v, arm.to, from, arm.constraint);
    }
  };
  std::vector<std::uint32_t> stack;
  std::uint32_t next = 0;
  for (std::uint32_t first = 0; first < n; ++first) {
    if (root_[first] != kNone) continue;
    root_[first] = first;
    for (push(first); !queue.empty();) {
      const auto [v, child, parent, edge] = queue.top();
      queue.pop();
      if (root_[child] != kNone) continue;
      attach(trusted, parent, child, edge);
      children[parent].push_back(child);
      push(child);
    }
    for (stack.push_back(first); !stack.empty();) {
      const std::uint32_t at = stack.back();
      stack.pop_back();
      order_[at] = next++;
      stack.insert(stack.end(), children[at].rbegin(), children[at].rend());
    }
  }
}

void TrustedTree::attach(const Graph& trusted, std::uint32_t parent, std::uint32_t child,
                         std::uint32_t constraint) {
  const Constraint& c = trusted.constraints[constraint];
  const types::RelPose step = index_.b(constraint) == child ? c.T_a_b : inverse(c.T_a_b);
  root_[child] = root_[parent];
  depth_[child] = depth_[parent] + 1;
  T_root_[child] = T_root_[parent] * step.T_a_b;
  P_[child] = P_[parent] + types::transported(step.cov, adjoint(T_root_[child]));
  for (std::uint32_t at = parent, level = 0;; ++level) {
    up_[child].push_back(at);
    if (up_[at].size() <= level) break;
    at = up_[at][level];
  }
}

std::uint32_t TrustedTree::commonAncestor(std::uint32_t i, std::uint32_t j) const {
  if (depth_[i] < depth_[j]) std::swap(i, j);
  for (std::size_t level = up_[i].size(); level-- > 0;)
    if (level < up_[i].size() && depth_[i] >= depth_[j] + (1u << level)) i = up_[i][level];
  for (std::size_t level = up_[i].size(); i != j && level-- > 0;)
    if (level < up_[i].size() && level < up_[j].size() && up_[i][level] != up_[j][level]) {
      i = up_[i][level];
      j = up_[j][level];
    }
  return i == j ? i : up_[i][0];
}

std::optional<types::RelPose> TrustedTree::between(std::uint32_t i, std::uint32_t j) const {
  if (root_[i] != root_[j]) return std::nullopt;
  const std::uint32_t top = commonAncestor(i, j);
  const types::Matrix6d A = adjoint(T_root_[j].inverse());
  return types::RelPose{.T_a_b = T_root_[i].inverse() * T_root_[j],
                        .cov = types::transported(P_[i] + P_[j] - 2 * P_[top], A)};
}

std::optional<Test> testCycle(const TrustedTree& tree, const Constraint& first, const Constraint& second,
                              const GateParams& params, bool planar) {
  const auto place = [&](PlaceId id) { return tree.index().index(id); };
  auto a = tree.between(place(second.a), place(first.a)), b = tree.between(place(first.b), place(second.b));
  if (!a || !b) return std::nullopt;
  const double factor = params.gate_inflation * params.gate_inflation;
  a->cov *= factor;
  b->cov *= factor;
  types::RelPose closure = first.T_a_b;
  const types::RelPose predicted = compose(compose(*a, closure), *b);
  closure.cov.setZero();
  const types::RelPose chains = compose(compose(*a, closure), *b);
  const auto gap = logSe3(second.T_a_b.T_a_b.inverse() * predicted.T_a_b);
  return testGap(gap, chains.cov, predicted.cov - chains.cov + second.T_a_b.cov, planar);
}

std::optional<Test> testCycle(const TrustedTree& tree, const Constraint& closure, const GateParams& params,
                              bool planar) {
  const auto chain = tree.between(tree.index().index(closure.a), tree.index().index(closure.b));
  if (!chain) return std::nullopt;
  const auto gap = logSe3(closure.T_a_b.T_a_b.inverse() * chain->T_a_b);
  return testGap(gap, params.gate_inflation * params.gate_inflation * chain->cov, closure.T_a_b.cov, planar);
}

ChainFinder::ChainFinder(const Graph& graph, bool planar)
    : graph_(graph), index_(graph), best_(index_.size(), kNever), via_(index_.size(), kNone) {
  for (const Constraint& c : graph.constraints) variance_.push_back(searchVariance(c, planar));
  for (const auto& [id, T] : graph.poses) T_map_.push_back(T);
}

std::optional<types::Matrix6d> ChainFinder::covariance(std::uint32_t a, std::uint32_t b, double limit) {
  for (const std::uint32_t i : touched_) best_[i] = kNever;
  touched_.clear();
  using Item = std::pair<double, std::uint32_t>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
  const auto reach = [&](std::uint32_t place, double variance, std::uint32_t constraint) {
    if (!(variance < best_[place]) || variance > limit) return;
    if (best_[place] == kNever) touched_.push_back(place);
    best_[place] = variance;
    via_[place] = constraint;
    queue.emplace(variance, place);
  };
  reach(a, 0, kNone);
  while (!queue.empty() && queue.top().second != b) {
    const auto [variance, at] = queue.top();
    queue.pop();
    if (variance > best_[at]) continue;
    for (const auto& arm : index_.arms(at))
      reach(arm.to, variance + variance_[arm.constraint], arm.constraint);
  }
  if (queue.empty()) return std::nullopt;
  // Back from b: each step is known in the frame of its end, and is carried to the frame of b.
  const Eigen::Isometry3d T_b_map = T_map_[b].inverse();
  types::Matrix6d cov = types::Matrix6d::Zero();
  for (std::uint32_t at = b; at != a;) {
    const Constraint& c = graph_.constraints[via_[at]];
    const std::uint32_t end = index_.b(via_[at]);
    cov += types::transported(c.T_a_b.cov, adjoint(T_b_map * T_map_[end]));
    at = end == at ? index_.a(via_[at]) : end;
  }
  return cov;
}

}  // namespace engram::posegraph
