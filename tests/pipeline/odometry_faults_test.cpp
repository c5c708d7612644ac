// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/odometry_watch.h"
#include "engram/pipeline/pipeline.h"
#include "tiny_drive.h"

#include <gmock/gmock.h>

#include <cmath>
#include <complex>

namespace engram::pipeline {
namespace {

using engram::testing::firstDrive;
using engram::testing::tinyParams;
using ::testing::HasSubstr;
using Frames = std::vector<types::Frame>;
using Point = std::complex<double>;

/// What became of a drive.
struct Mapped {
  std::size_t places = 0;
  double error = 0;  ///< of the places, root mean square after alignment in the plane [m]
  OdometryHealth wheels;
};

/// After the best alignment in the plane, points as complex numbers.
double alignedError(std::vector<Point> found, std::vector<Point> truth) {
  const auto centre = [](std::vector<Point>& points) {
    Point sum = 0;
    for (const Point& p : points) sum += p;
    for (Point& p : points) p -= sum / static_cast<double>(points.size());
  };
  centre(found);
  centre(truth);
  Point turn = 0;
  for (std::size_t i = 0; i < found.size(); ++i) turn += truth[i] * std::conj(found[i]);
  double squares = 0;
  for (std::size_t i = 0; i < found.size(); ++i)
    squares += std::norm(truth[i] - found[i] * turn / std::abs(turn));
  return std::sqrt(squares / static_cast<double>(found.size()));
}

Mapped mapped(const Frames& frames) {
  Pipeline mapper(tinyParams());
  for (const types::Frame& frame : frames) mapper.process(frame);
  mapper.finish();
  std::vector<Point> found, truth;
  for (const auto& [id, place] : mapper.map().places()) {
    const auto& T_world_robot = firstDrive().T_world_robot[place.createdIndex];
    found.emplace_back(place.T_map_place.translation().x(), place.T_map_place.translation().y());
    truth.emplace_back(T_world_robot.translation().x(), T_world_robot.translation().y());
  }
  return {found.size(), alignedError(found, truth), mapper.wheels()};
}

/// The drive as another odometry tells it.
template <class Change>
Frames retold(Change change) {
  Frames frames = firstDrive().frames;
  for (types::Frame& frame : frames) frame.T_odom_robot = change(frame.index, *frame.T_odom_robot);
  return frames;
}

std::size_t middle() { return firstDrive().frames.size() / 2; }
const Eigen::Isometry3d& odometryAt(std::size_t i) { return *firstDrive().frames[i].T_odom_robot; }

const Mapped& undisturbed() {
  static const Mapped once = mapped(firstDrive().frames);
  return once;
}

TEST(OdometryFaults, SoundOdometryHasNone) {
  EXPECT_EQ(describe(undisturbed().wheels), "");
  EXPECT_LT(undisturbed().error, 0.1);
}

/// Before the watch: 2.7 m.
TEST(OdometryFaults, ACounterThatBeginsAnewCostsOneWay) {
  const Mapped m = mapped(retold([](std::size_t i, const Eigen::Isometry3d& T) {
    return i < middle() ? T : odometryAt(middle()).inverse() * T;
  }));
  EXPECT_EQ(m.wheels.leaps, 1);
  EXPECT_EQ(faultOf(m.wheels), OdometryFault::kLeaps);
  EXPECT_LT(m.error, 0.3);
  EXPECT_LE(m.places, undisturbed().places + 2);
}

/// Before the watch: 226 km.
TEST(OdometryFaults, OneWildReadingCostsTwoWays) {
  const Mapped m = mapped(retold([](std::size_t i, Eigen::Isometry3d T) {
    if (i == middle()) T.translation().x() += 1e6;
    return T;
  }));
  EXPECT_EQ(m.wheels.leaps, 2);
  EXPECT_LT(m.error, 0.5);
  EXPECT_LE(m.places, undisturbed().places + 2);
}

TEST(OdometryFaults, MillimetresAreLeftOutAndNamed) {
  const Mapped m = mapped(retold([](std::size_t, Eigen::Isometry3d T) {
    T.translation() *= 1000;
    return T;
  }));
  EXPECT_TRUE(isGrave(m.wheels));
  EXPECT_THAT(describe(m.wheels), HasSubstr("is it in metres?"));
}

TEST(OdometryFaults, AMirroredAxisIsNamedWithItsRatio) {
  const Mapped m = mapped(retold([](std::size_t, const Eigen::Isometry3d& T) {
    Eigen::Isometry3d mirrored = T;
    mirrored.translation().y() *= -1;
    mirrored.linear() = T.linear().transpose();
    return mirrored;
  }));
  EXPECT_TRUE(isGrave(m.wheels));
  EXPECT_NEAR(m.wheels.headingRatio, -1, 0.1);
  EXPECT_THAT(describe(m.wheels), HasSubstr("turns the other way"));
}

/// Before the watch one place of 38 images.
TEST(OdometryFaults, ADeadEncoderMakesAMapWithoutOdometry) {
  const Mapped m = mapped(retold([](std::size_t, const Eigen::Isometry3d&) { return odometryAt(0); }));
  EXPECT_EQ(faultOf(m.wheels), OdometryFault::kFrozen);
  EXPECT_GE(m.places, undisturbed().places);
}

/// The first drive with wheels of another radius.
Frames withWheels(double factor) {
  return retold([factor](std::size_t, Eigen::Isometry3d T) {
    T.translation() *= factor;
    return T;
  });
}

/// Length of the map over the true one: of all straight distances between its places.
double lengthOf(const map::TopologicalMap& map) {
  const auto at = [](const map::Place& place) { return firstDrive().T_world_robot[place.createdIndex]; };
  double found = 0, truth = 0;
  for (const auto& [i, a] : map.places())
    for (const auto& [k, b] : map.places()) {
      found += (a.T_map_place.translation() - b.T_map_place.translation()).norm();
      truth += (at(a).translation() - at(b).translation()).norm();
    }
  return found / truth;
}

/// Wheels 2 % too small, then 2 % too large: the map is half way after two drives, and as good as true.
TEST(OdometryFaults, EachDriveIsAVoteOnTheMetre) {
  const auto drive = [](map::TopologicalMap known, double factor) {
    Pipeline mapper(tinyParams(), std::move(known));
    for (const types::Frame& frame : withWheels(factor)) mapper.process(frame);
    mapper.finish();
    return mapper.map();
  };
  const double sound = lengthOf(drive({}, 1));
  const map::TopologicalMap first = drive({}, 1.02);
  EXPECT_NEAR(lengthOf(first) / sound, 1.02, 0.003);
  EXPECT_NEAR(lengthOf(drive(first, 0.98)) / sound, 1, 0.006);
}

/// A second drive whose odometry no wheel radius explains does not stretch the map. With a vote: by 13 %.
TEST(OdometryFaults, AnotherUnitHasNoVoteOnTheMetre) {
  Pipeline first(tinyParams());
  for (const types::Frame& frame : firstDrive().frames) first.process(frame);
  first.finish();
  Pipeline second(tinyParams(), first.map());
  for (const types::Frame& frame : withWheels(1.3)) second.process(frame);
  second.finish();
  EXPECT_NEAR(lengthOf(second.map()) / lengthOf(first.map()), 1, 0.01);
}

}  // namespace
}  // namespace engram::pipeline
