// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "../odometry/world_pairs.h"
#include "engram/cameras/pinhole.h"
#include "engram/odometry/stereo_check.h"
#include "engram/odometry/stereo_odometry.h"

#include <benchmark/benchmark.h>
#include <opencv2/core/utility.hpp>

namespace engram::odometry {
namespace {

using namespace testing_world;

/// 0.8 m of the office at 15 Hz and 0.5 m/s, 640 x 480, the simulator's head (K-34).
const Rectified& drive() {
  static const Rectified pairs = [] {
    const auto rig = cameras::loadStereoRig(ENGRAM_SOURCE_DIR "/share/cameras/stereo_world.ini");
    return rectify(rig, driveThroughOffice(rig, 24, 1.0 / 30));
  }();
  return pairs;
}

/// There and back, without end.
const types::StereoPair& pairAt(std::size_t i) {
  const auto& pairs = drive().pairs;
  const std::size_t period = 2 * pairs.size() - 2, at = i % period;
  return pairs[std::min(at, period - at)];
}

/// A frame of visual odometry on one core, keyframes included; the argument is `step` frames at once.
void odometryFrame(benchmark::State& state) {
  cv::setNumThreads(1);
  StereoOdometry odometry(drive().rectifier.model(), drive().rectifier.mask(), {});
  const auto step = static_cast<std::size_t>(state.range(0));
  std::size_t i = 0;
  double keyframes = 0, ok = 0, wide = 0, inliers = 0;
  for (auto _ : state) {
    const auto result = odometry.process(pairAt(step * i++));
    keyframes += result.newKeyframe;
    ok += result.ok();
    wide += result.wideBaseline;
    inliers += result.inliers;
  }
  const auto n = static_cast<double>(state.iterations());
  state.counters["keyframes"] = keyframes / n;
  state.counters["ok"] = ok / n;
  state.counters["wide"] = wide / n;
  state.counters["inliers"] = inliers / n;
}
BENCHMARK(odometryFrame)->ArgName("step")->Arg(1)->Arg(3)->Unit(benchmark::kMillisecond);

/// The frame that becomes a keyframe: corners and their disparities besides the rest.
void keyframeEveryFrame(benchmark::State& state) {
  cv::setNumThreads(1);
  OdometryParams params;
  params.keyframe_score = 1;
  StereoOdometry odometry(drive().rectifier.model(), drive().rectifier.mask(), params);
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(odometry.process(pairAt(i++)));
}
BENCHMARK(keyframeEveryFrame)->Unit(benchmark::kMillisecond);

void rectifyPair(benchmark::State& state) {
  cv::setNumThreads(1);
  auto rig = cameras::loadStereoRig(ENGRAM_SOURCE_DIR "/share/cameras/stereo_world.ini");
  auto plane = dynamic_cast<const cameras::Pinhole&>(*rig.left.camera).plane();
  plane.k1 = -0.2, plane.k2 = 0.04;
  rig.left.camera = std::make_shared<cameras::Pinhole>(rig.left.camera->imageSize(), plane);
  const cameras::Rectifier rectifier(rig);
  std::size_t i = 0;
  for (auto _ : state) {
    const auto& pair = pairAt(i++);
    benchmark::DoNotOptimize(rectifier(pair.left, pair.right));
  }
}
BENCHMARK(rectifyPair)->Unit(benchmark::kMillisecond);

/// Per frame of a drive: the check looks at two pairs in ten.
void checkEyes(benchmark::State& state) {
  cv::setNumThreads(1);
  StereoCheck check;
  std::size_t i = 0;
  for (auto _ : state) check.add(pairAt(i++));
}
BENCHMARK(checkEyes)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace engram::odometry

BENCHMARK_MAIN();
