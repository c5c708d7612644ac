// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "graph_samples.h"

#include <set>

namespace engram::posegraph {

/// A long drive with its truth, odometry and closures.
struct Drive {
  std::vector<Eigen::Isometry3d> truth;
  Graph trusted;  ///< odometry; poses as odometry has them
  std::vector<Constraint> closures;
  std::vector<char> isTrue;  ///< of each closure
};

namespace drive_detail {

constexpr double kCell = 2.0;  // [m]

struct Noise {
  double along = 0.02, across = 0.01, heading = 0.004;  ///< a step of 1 m: [m], [m], [rad]
  double closure = 0.1, closureHeading = 0.02;          ///< [m], [rad]
};

inline types::Matrix6d planarCov(double x, double y, double yaw) {
  types::Matrix6d cov = types::Matrix6d::Zero();
  cov.diagonal() << x * x, y * y, 1e-4, 1e-4, 1e-4, yaw * yaw;
  return cov;
}

inline Eigen::Isometry3d noisy(const Eigen::Isometry3d& T, base::Rng& rng, double x, double y, double yaw) {
  Vector6d d = Vector6d::Zero();
  d << rng.normal(0, x), rng.normal(0, y), 0, 0, 0, rng.normal(0, yaw);
  return T * expSe3(d);
}

inline void addOdometry(Drive& drive, base::Rng& rng, const Noise& noise) {
  drive.trusted.poses[p(0)] = drive.truth[0];
  for (std::uint32_t i = 0; i + 1 < drive.truth.size(); ++i) {
    const Eigen::Isometry3d step = drive.truth[i].inverse() * drive.truth[i + 1];
    const double turn = 0.03 * std::abs(std::atan2(step(1, 0), step(0, 0)));
    const double heading = std::hypot(noise.heading, turn);
    const Eigen::Isometry3d T = noisy(step, rng, noise.along, noise.across, heading);
    drive.trusted.constraints.push_back(
        constraint(i, i + 1, T, planarCov(noise.along, noise.across, heading)));
    drive.trusted.poses[p(i + 1)] = drive.trusted.poses.at(p(i)) * T;
  }
}

inline void addClosure(Drive& drive, std::uint32_t a, std::uint32_t b, const Eigen::Isometry3d& T,
                       base::Rng& rng, const Noise& noise, bool isTrue) {
  drive.closures.push_back(constraint(a, b, noisy(T, rng, noise.closure, noise.closure, noise.closureHeading),
                                      planarCov(noise.closure, noise.closure, noise.closureHeading), true));
  drive.isTrue.push_back(isTrue);
}

/// True closures between places within 1.5 m of each other and 50 places apart in time; each place finds one
/// with the given probability.
inline void addTrueClosures(Drive& drive, base::Rng& rng, const Noise& noise, double probability) {
  std::map<std::pair<long, long>, std::vector<std::uint32_t>> cells;
  const auto cellOf = [&](std::uint32_t i) {
    const Eigen::Vector3d t = drive.truth[i].translation();
    return std::pair{std::lround(t.x() / kCell), std::lround(t.y() / kCell)};
  };
  for (std::uint32_t i = 0; i < drive.truth.size(); ++i) {
    const auto [cx, cy] = cellOf(i);
    std::vector<std::uint32_t> near;
    for (long x = cx - 1; x <= cx + 1; ++x)
      for (long y = cy - 1; y <= cy + 1; ++y)
        for (const std::uint32_t j : cells[{x, y}])
          if (j + 50 < i && (drive.truth[j].translation() - drive.truth[i].translation()).norm() < 1.5)
            near.push_back(j);
    cells[{cx, cy}].push_back(i);
    if (near.empty() || rng.uniform() > probability) continue;
    const std::uint32_t j = near[rng.below(static_cast<std::uint32_t>(near.size()))];
    addClosure(drive, i, j, drive.truth[i].inverse() * drive.truth[j], rng, noise, true);
  }
}

inline Drive finished(std::vector<Eigen::Isometry3d> truth, std::uint64_t seed, double probability) {
  base::Rng rng(seed);
  Drive drive;
  drive.truth = std::move(truth);
  addOdometry(drive, rng, {});
  addTrueClosures(drive, rng, {}, probability);
  return drive;
}

/// Steps of 1 m along a closed polygon, with a little sideways wander.
inline void drivePolygon(std::vector<Eigen::Isometry3d>& truth, const std::vector<Eigen::Vector2d>& corners,
                         base::Rng& rng) {
  for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
    const Eigen::Vector2d side = corners[k + 1] - corners[k];
    const int n = static_cast<int>(std::lround(side.norm()));
    const Eigen::Vector2d u = side.normalized();
    for (int i = 0; i < n; ++i) {
      const Eigen::Vector2d at =
          corners[k] + (i + 0.5) * u + rng.uniform(-0.3, 0.3) * Eigen::Vector2d(-u.y(), u.x());
      truth.push_back(planarPose(at.x(), at.y(), std::atan2(u.y(), u.x())));
    }
  }
}

inline std::vector<Eigen::Vector2d> rectangle(double x, double y, double width, double height) {
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}, {x, y}};
}

}  // namespace drive_detail

/// A walk on a square of streets one metre apart in both directions, turning at random.
inline Drive manhattan(std::uint32_t n, std::uint64_t seed) {
  base::Rng rng(seed);
  const double side = 0.5 * std::sqrt(static_cast<double>(n)) * 2;
  std::vector<Eigen::Isometry3d> truth{planarPose(0, 0, 0)};
  int heading = 0;
  while (truth.size() < n) {
    Eigen::Vector3d t = truth.back().translation();
    const double turn = rng.uniform();
    if (turn < 0.08) heading = (heading + 1) % 4;
    if (turn > 0.92) heading = (heading + 3) % 4;
    const auto ahead = [&] {
      return Eigen::Vector2d(t.x() + std::round(std::cos(heading * M_PI / 2)),
                             t.y() + std::round(std::sin(heading * M_PI / 2)));
    };
    while (ahead().cwiseAbs().maxCoeff() > side / 2) heading = (heading + 1) % 4;
    truth.push_back(planarPose(ahead().x(), ahead().y(), heading * M_PI / 2));
  }
  return drive_detail::finished(std::move(truth), seed + 1, 0.4);
}

/// Laps of one long rectangular corridor.
inline Drive corridor(std::uint32_t n, std::uint64_t seed, int laps = 5) {
  base::Rng rng(seed);
  const double length = n / static_cast<double>(laps) / 2;
  std::vector<Eigen::Isometry3d> truth;
  while (truth.size() < n)
    drive_detail::drivePolygon(
        truth, drive_detail::rectangle(0, 0, std::round(0.7 * length), std::round(0.3 * length)), rng);
  truth.resize(n);
  return drive_detail::finished(std::move(truth), seed + 1, 0.3);
}

/// Three buildings in a row, two rounds in each, and the whole tour three times.
inline Drive buildings(std::uint32_t n, std::uint64_t seed) {
  base::Rng rng(seed);
  const double round = n / 3.0 / 3 / 2.4;  // [m]
  const double w = std::round(round * 0.3), h = std::round(round * 0.2), gap = std::round(round * 0.3);
  std::vector<Eigen::Isometry3d> truth;
  while (truth.size() < n) {
    for (int k = 0; k < 3; ++k) {
      const double x = k * (w + gap);
      for (int lap = 0; lap < 2; ++lap)
        drive_detail::drivePolygon(truth, drive_detail::rectangle(x, 0, w, h), rng);
      if (k < 2)
        drive_detail::drivePolygon(truth, {{x, 0}, {x, -5}, {x + w + gap, -5}, {x + w + gap, 0}}, rng);
    }
    drive_detail::drivePolygon(truth, {{2 * (w + gap), 0}, {2 * (w + gap), -8}, {0, -8}, {0, 0}}, rng);
  }
  truth.resize(n);
  return drive_detail::finished(std::move(truth), seed + 1, 0.3);
}

/// Adds false closures until they are `share` of all. Random ones say that two places far apart are one. With
/// `clustered` they come in runs of 5 to 20, as when one stretch looks like another: all of a run agree.
inline void addLies(Drive& drive, double share, bool clustered, std::uint64_t seed) {
  base::Rng rng(seed);
  const auto n = static_cast<std::uint32_t>(drive.truth.size());
  const auto wanted =
      static_cast<std::size_t>(std::lround(share / (1 - share) * static_cast<double>(drive.closures.size())));
  const auto apart = [&](std::uint32_t a, std::uint32_t b) {
    return (drive.truth[a].translation() - drive.truth[b].translation()).norm() > 5;
  };
  for (std::size_t made = 0; made < wanted;) {
    const std::uint32_t length = clustered ? 5 + rng.below(16) : 1;
    const std::uint32_t a = rng.below(n - length), b = rng.below(n - length);
    if (a < b + 50 + length || !apart(a, b) || !apart(a + length, b + length)) continue;
    const double yaw = clustered ? rng.normal(0, 0.1) : rng.uniform(-M_PI, M_PI);
    const Eigen::Isometry3d X = planarPose(rng.normal(0, 0.5), rng.normal(0, 0.5), yaw);
    for (std::uint32_t k = 0; k < length && made < wanted; ++k, ++made) {
      // In the truth of both stretches, one laid over the other.
      const Eigen::Isometry3d T =
          drive.truth[a + k].inverse() * drive.truth[a] * X * drive.truth[b].inverse() * drive.truth[b + k];
      drive_detail::addClosure(drive, a + k, b + k, T, rng, {}, false);
    }
  }
}

/// Absolute trajectory error [m]: root mean square after the best planar alignment.
inline double ate(const std::vector<Eigen::Isometry3d>& truth,
                  const std::map<PlaceId, Eigen::Isometry3d>& poses) {
  Eigen::Vector2d ct(0, 0), ce(0, 0);
  for (std::uint32_t i = 0; i < truth.size(); ++i) {
    ct += truth[i].translation().head<2>();
    ce += poses.at(p(i)).translation().head<2>();
  }
  ct /= static_cast<double>(truth.size());
  ce /= static_cast<double>(truth.size());
  double cosine = 0, sine = 0;
  for (std::uint32_t i = 0; i < truth.size(); ++i) {
    const Eigen::Vector2d t = truth[i].translation().head<2>() - ct,
                          e = poses.at(p(i)).translation().head<2>() - ce;
    cosine += t.dot(e);
    sine += e.x() * t.y() - e.y() * t.x();
  }
  const Eigen::Rotation2Dd R(std::atan2(sine, cosine));
  double sum = 0;
  for (std::uint32_t i = 0; i < truth.size(); ++i)
    sum += (truth[i].translation().head<2>() - ct - R * (poses.at(p(i)).translation().head<2>() - ce))
               .squaredNorm();
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

}  // namespace engram::posegraph
