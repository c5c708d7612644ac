// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Synthetic camera clocks with known offset, drift and network delays.
#include "clock_map.h"

#include "engram/base/rng.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace engram::capture {
namespace {

constexpr std::int64_t kHostStart = 1'700'000'000'000'000'000;  // [ns]
constexpr double kLeastDelay = 300e-6;                          // [s]

/// A camera whose clock shows `device` ns at kHostStart and runs slower than the host's by `drift`.
struct Camera {
  std::int64_t device = 123'456'789'000;
  double drift = 0.0;
  std::int64_t deviceAt(double t) const { return device + std::llround(t / (1.0 + drift) * 1e9); }
};

std::int64_t hostAt(double t) { return kHostStart + std::llround(t * 1e9); }

/// A delay that is never below the least, mostly near it, and sometimes very long: 5 % are late by up to 80
/// ms.
double jitter(base::Rng& rng) {
  double delay = kLeastDelay - 0.5e-3 * std::log(1.0 - rng.uniform());
  if (rng.uniform() < 0.05) delay += rng.uniform(0.0, 0.08);
  return delay;
}

/// Errors [s] of the mapped stamps of `seconds` at `rate` against the true times of exposure.
std::vector<double> errors(ClockMap& map, const Camera& camera, double from, double seconds, double rate,
                           base::Rng& rng) {
  std::vector<double> result;
  for (double t = from; t < from + seconds; t += 1.0 / rate) {
    const std::int64_t host = map.toHost(camera.deviceAt(t), hostAt(t + jitter(rng)));
    result.push_back(static_cast<double>(host - hostAt(t)) * 1e-9);
  }
  return result;
}

double worst(const std::vector<double>& errors, std::size_t from) {
  double value = 0.0;
  for (std::size_t i = from; i < errors.size(); ++i)
    value = std::max(value, std::abs(errors[i] - kLeastDelay));
  return value;
}

TEST(ClockMap, FindsOffsetAndDriftUnderHeavyJitter) {
  for (const double drift : {0.0, 30e-6, -80e-6, 200e-6}) {
    base::Rng rng(7);
    ClockMap map;
    const Camera camera{.drift = drift};
    const auto e = errors(map, camera, 0.0, 300.0, 20.0, rng);
    EXPECT_NEAR(map.drift(), drift, 2e-6) << drift;
    EXPECT_LT(worst(e, 20 * 60), 0.3e-3) << drift;  // after a minute
    EXPECT_EQ(map.restarts(), 0u);
  }
}

TEST(ClockMap, IsGoodFromTheFirstSecondsOn) {
  base::Rng rng(8);
  ClockMap map;
  const auto e = errors(map, {.drift = 50e-6}, 0.0, 12.0, 30.0, rng);
  EXPECT_LT(worst(e, 30), 2e-3);  // 10 s of drift, 0.5 ms, are not seen yet
}

TEST(ClockMap, FollowsADriftThatChangesWithTemperature) {
  base::Rng rng(9);
  ClockMap map;
  Camera camera{.drift = 20e-6};
  errors(map, camera, 0.0, 300.0, 20.0, rng);
  camera.device = camera.deviceAt(300.0) - std::llround(300.0 / (1.0 + 60e-6) * 1e9);
  camera.drift = 60e-6;
  const auto e = errors(map, camera, 300.0, 300.0, 20.0, rng);
  EXPECT_NEAR(map.drift(), 60e-6, 3e-6);
  EXPECT_LT(worst(e, 0), 3e-3);           // while it learns
  EXPECT_LT(worst(e, 20 * 180), 0.3e-3);  // when the old drift has left the window
}

TEST(ClockMap, StampsRiseWhateverHappens) {
  base::Rng rng(10);
  ClockMap map;
  std::int64_t last = 0;
  for (int i = 0; i < 20000; ++i) {
    const double t = 1e-3 * i;  // 1 kHz: a correction could easily exceed the interval
    const std::int64_t host = map.toHost(Camera{.drift = 1e-4}.deviceAt(t), hostAt(t + jitter(rng)));
    ASSERT_GT(host, last);
    last = host;
  }
}

TEST(ClockMap, OneLateFrameMovesNothing) {
  base::Rng rng(11);
  ClockMap map;
  const Camera camera{.drift = 40e-6};
  errors(map, camera, 0.0, 60.0, 20.0, rng);
  const std::int64_t late = map.toHost(camera.deviceAt(60.0), hostAt(65.0));  // stuck for 5 s
  EXPECT_NEAR(static_cast<double>(late - hostAt(60.0)) * 1e-9, kLeastDelay, 0.3e-3);
  EXPECT_LT(worst(errors(map, camera, 60.1, 20.0, 20.0, rng), 0), 0.3e-3);
  EXPECT_EQ(map.restarts(), 0u);
}

TEST(ClockMap, BeginsAnewWhenTheCameraIsRestarted) {
  base::Rng rng(12);
  ClockMap map;
  errors(map, {.device = 5'000'000'000'000}, 0.0, 30.0, 20.0, rng);
  const auto e = errors(map, {.device = -39'000'000'000}, 40.0, 30.0, 20.0, rng);  // counts from 1 s again
  EXPECT_EQ(map.restarts(), 1u);
  EXPECT_LT(worst(e, 20), 1e-3);
  map.restart();
  EXPECT_EQ(map.restarts(), 2u);
}

TEST(ClockMap, BeginsAnewWhenTheHostsClockIsSet) {
  for (const double step : {-3600.0, 3600.0}) {
    base::Rng rng(13);
    ClockMap map;
    const Camera camera{.drift = 10e-6};
    errors(map, camera, 0.0, 30.0, 20.0, rng);
    std::vector<double> e;
    for (double t = 30.0; t < 60.0; t += 0.05) {
      const std::int64_t host = map.toHost(camera.deviceAt(t), hostAt(t + step + jitter(rng)));
      e.push_back(static_cast<double>(host - hostAt(t + step)) * 1e-9);
    }
    EXPECT_EQ(map.restarts(), 1u) << step;
    EXPECT_LT(worst(e, 40), 2e-3) << step;
  }
}

}  // namespace
}  // namespace engram::capture
