// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scans/scans_filter.h"

#include "common/cpu_clock.h"
#include "engram/base/rng.h"
#include "engram/evaluation/trajectory_error.h"
#include "engram/posegraph/relaxer.h"
#include "engram/posegraph/scan_filter.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>

namespace engram::apps {
namespace {

using Eigen::Isometry3d;
using posegraph::PlaceId;

constexpr double kStep = 0.5;   // [m] between images
constexpr double kReach = 1.2;  // [m] at which a reference is matched: one in two images becomes one
constexpr double kWheels = 0.02, kWheelsTurn = 0.01;  // [m], [rad] noise of a step
constexpr double kMatch = 0.01, kMatchTurn = 0.004;   // of a match
constexpr double kGate = 0.99;

types::Matrix6d noise(double sigma, double turn) {
  types::Vector6d v;
  v << sigma * sigma, sigma * sigma, 1e-6, 1e-6, 1e-6, turn * turn;
  return v.asDiagonal();
}

/// Once round a square whose corridor has room for `references`, and on over its beginning.
class Round {
 public:
  Round(int references, base::Rng rng) : side_(references * 2 * kStep / 4), rng_(rng) {}

  int steps() const { return static_cast<int>(4 * side_ / kStep) + 12; }
  Isometry3d truth(int k) const {
    const double s = std::fmod(k * kStep, 4 * side_);
    const int edge = static_cast<int>(s / side_);
    const double corners[4][2] = {{0, 0}, {side_, 0}, {side_, side_}, {0, side_}};
    Isometry3d T = Isometry3d::Identity();
    T.linear() = Eigen::AngleAxisd(edge * M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    T.translation() = Eigen::Vector3d(corners[edge][0], corners[edge][1], 0) +
                      T.linear() * Eigen::Vector3d(s - edge * side_, 0, 0);
    return T;
  }
  types::RelPose wheels(int k) { return drawn(truth(k - 1).inverse() * truth(k), kWheels, kWheelsTurn); }
  types::RelPose match(const Isometry3d& T_a_b) { return drawn(T_a_b, kMatch, kMatchTurn); }

 private:
  types::RelPose drawn(const Isometry3d& T, double sigma, double turn) {
    types::Vector6d d = types::Vector6d::Zero();
    d[0] = rng_.normal(0, sigma);
    d[1] = rng_.normal(0, sigma);
    d[5] = rng_.normal(0, turn);
    return {.T_a_b = T * types::expSe3(d), .cov = noise(sigma, turn)};
  }
  double side_;
  base::Rng rng_;
};

/// What one image measures.
struct Image {
  types::RelPose wheels;
  std::vector<std::pair<PlaceId, types::RelPose>> references;
  types::RelPose previous;
  PlaceId promoted;  ///< the scan before, when it becomes a reference
};

struct Script {
  std::vector<Image> images;
  std::map<PlaceId, Isometry3d> truth;
};

/// By V-08 with the truth as prediction, so that both back-ends measure the same.
Script scriptOf(Round& round) {
  Script script;
  for (int k = 1; k <= round.steps(); ++k) {
    Image image{round.wheels(k), {}, {}, {}};
    for (const auto& [name, T] : script.truth) {
      const Isometry3d T_a_b = T.inverse() * round.truth(k);
      if (T_a_b.translation().norm() < kReach) image.references.emplace_back(name, round.match(T_a_b));
    }
    if (image.references.empty()) {
      image.previous = round.match(round.truth(k - 1).inverse() * round.truth(k));
      image.promoted = PlaceId(static_cast<std::uint32_t>(script.truth.size()));
      script.truth[image.promoted] = round.truth(k - 1);
    }
    script.images.push_back(std::move(image));
  }
  return script;
}

void filterOne(posegraph::ScanFilter& filter, const Image& image) {
  filter.predict(image.wheels);
  for (const auto& [name, z] : image.references) filter.measure(name, z, kGate);
  if (!image.promoted.valid()) return;
  filter.measure(PlaceId(), image.previous, kGate);
  filter.promote(image.promoted);
}

/// References as a graph: a link between those that one image saw, the wheels from one to the next.
class GraphOfScans {
 public:
  explicit GraphOfScans(const posegraph::RelaxerParams& params)
      : params_(params), relaxer_(posegraph::makeRelaxer(params)) {}

  void add(const Image& image) {
    const types::RelPose before = T_last_robot_;
    T_last_robot_ = posegraph::compose(T_last_robot_, image.wheels);
    if (!image.references.empty()) {
      const auto [first, seen] = image.references.front();
      if (last_.valid()) close(last_, T_last_robot_, first, seen);
      for (const auto& [other, z] : image.references) close(first, seen, other, z);
      last_ = first;
      T_last_robot_ = seen;
    }
    if (!image.promoted.valid()) return;
    graph_.poses[image.promoted] =
        last_.valid() ? graph_.poses.at(last_) * before.T_a_b : Isometry3d(Isometry3d::Identity());
    if (last_.valid()) join(last_, image.promoted, before);
    posegraph::relaxAround(*relaxer_, params_, graph_, adjacency_, image.promoted);
    last_ = image.promoted;
    T_last_robot_ = image.previous;
  }
  const std::map<PlaceId, Isometry3d>& poses() const { return graph_.poses; }

 private:
  void join(PlaceId a, PlaceId b, const types::RelPose& T) {
    adjacency_.add(graph_.constraints.size(), a, b);
    graph_.constraints.push_back({a, b, T});
  }
  void close(PlaceId a, const types::RelPose& T_a_robot, PlaceId b, const types::RelPose& T_b_robot) {
    if (a == b || (b.value > a.value ? b.value - a.value : a.value - b.value) <= 2) return;
    join(a, b, posegraph::compose(T_a_robot, posegraph::inverse(T_b_robot)));
    graph_.poses = relaxer_->relax(graph_).poses;
  }

  posegraph::RelaxerParams params_;
  std::unique_ptr<posegraph::Relaxer> relaxer_;
  posegraph::Graph graph_;
  posegraph::Adjacency adjacency_;
  PlaceId last_;
  types::RelPose T_last_robot_{.cov = types::Matrix6d::Zero()};
};

/// CPU an image of the last ones: the map has its size then, and the loop closes.
double msOfLast(const std::vector<Image>& images, const std::function<void(const Image&)>& take) {
  constexpr std::size_t kTimed = 24;
  const std::size_t first = images.size() - std::min(kTimed, images.size());
  double start = threadSeconds();
  for (std::size_t k = 0; k < images.size(); ++k) {
    if (k == first) start = threadSeconds();
    take(images[k]);
  }
  return 1000 * (threadSeconds() - start) / static_cast<double>(images.size() - first);
}

double ateOf(const std::map<PlaceId, Isometry3d>& poses, const std::map<PlaceId, Isometry3d>& truths) {
  evaluation::Trajectory estimate, truth;
  for (const auto& [name, T] : poses) {
    estimate.push_back({static_cast<double>(name.value), T});
    truth.push_back({static_cast<double>(name.value), truths.at(name)});
  }
  const auto error = evaluation::ate(estimate, truth, evaluation::Alignment::kSe2);
  return error ? error->rmse : 0.0;
}

}  // namespace

double NeesFigures::inside() const {
  const auto n = std::count_if(steps.begin(), steps.end(),
                               [this](const NeesStep& s) { return s.nees >= low && s.nees <= high; });
  return steps.empty() ? 0.0 : static_cast<double>(n) / static_cast<double>(steps.size());
}

NeesFigures measureNees(int runs, std::uint64_t seed) {
  constexpr int kReferences = 40;
  NeesFigures figures;
  figures.runs = runs;
  // The sum is chi-square with 3 degrees of freedom a run.
  figures.low = posegraph::chi2Bound(0.025, 3 * runs) / runs;
  figures.high = posegraph::chi2Bound(0.975, 3 * runs) / runs;
  for (int run = 0; run < runs; ++run) {
    Round round(kReferences, base::Rng(seed).fork(static_cast<std::uint64_t>(run)));
    const Script script = scriptOf(round);
    posegraph::ScanFilter filter;
    filter.start(round.truth(0));
    figures.steps.resize(script.images.size());
    for (std::size_t k = 0; k < script.images.size(); ++k) {
      filterOne(filter, script.images[k]);
      const auto d = types::logSe3(round.truth(static_cast<int>(k) + 1) * filter.T_map_robot().inverse());
      const Eigen::Vector3d e(d[0], d[1], d[5]);
      const Eigen::Matrix3d P = filter.robotCovariance();
      figures.steps[k].way = kStep * static_cast<double>(k + 1);
      figures.steps[k].nees += e.dot(P.ldlt().solve(e)) / runs;
    }
  }
  return figures;
}

SizeFigures compareAt(int references, std::uint64_t seed) {
  Round round(references, base::Rng(seed));
  const Script script = scriptOf(round);
  SizeFigures figures;
  figures.references = static_cast<int>(script.truth.size());

  posegraph::ScanFilter filter;
  filter.start(Isometry3d::Identity());
  figures.ekfMs = msOfLast(script.images, [&](const Image& image) { filterOne(filter, image); });
  figures.ekfAte = ateOf(filter.references(), script.truth);

  GraphOfScans graph({});
  figures.graphMs = msOfLast(script.images, [&](const Image& image) { graph.add(image); });
  figures.graphAte = ateOf(graph.poses(), script.truth);
  return figures;
}

}  // namespace engram::apps
