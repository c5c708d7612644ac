// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/world.h"

#include "engram/base/error.h"
#include "engram/cameras/stereo_rig.h"
#include "preset_cameras.h"

#include <cmath>
#include <cstdio>
#include <numbers>

namespace engram::world {
namespace {

constexpr int kExposureSteps = 4;       // poses within one exposure
constexpr double kPersonalSpace = 0.7;  // [m] between people and the robot

}  // namespace

Eyes presetEyes(const std::string& name) {
  if (name == "omni") return {name, cameras::parseCamera(kOmniCamera, "omni_world.ini"), {}};
  if (name == "pinhole") return {name, cameras::parseCamera(kPinholeCamera, "pinhole_world.ini"), {}};
  if (name == "stereo") {
    auto [left, right] = cameras::parseStereoRig(kStereoCamera, "stereo_world.ini");
    return {name, std::move(left), std::move(right)};
  }
  throw base::Error("unknown camera '" + name + "'; use omni, pinhole, stereo or a calibration file (.ini)");
}

World::World(const Plan& plan, const WorldParams& params)
    : params_(params), building_(plan, params.seed), library_(building_, params.photographs), route_(plan) {
  base::validate(params.change);
  base::validate(params.drive);
  base::validate(params.sensor);
}

Session::Session(const World& world, int number, Eyes eyes, DriveKind kind, int threads)
    : world_(world),
      eyes_(std::move(eyes)),
      appearance_(world.appearance(number)),
      scene_(world.building(), appearance_, world.library(), threads),
      drive_(world.route(), world.params().drive, kind,
             base::Rng(world.params().seed)
                 .fork(5000 + static_cast<std::uint64_t>(number) * 2 + (kind == DriveKind::kTest))
                 .bits()),
      start_(appearance_.stamp()),
      seed_(base::Rng(world.params().seed)
                .fork(900000 + static_cast<std::uint64_t>(number) * 2 + (kind == DriveKind::kTest))
                .bits()),
      left_(eyes_.left, world.params().sensor) {
  if (eyes_.right) right_.emplace(*eyes_.right, world.params().sensor);
  meterAll();
}

Eigen::Isometry3d Session::T_world_robot(std::size_t i) const {
  return toIsometry(drive_.poseAt(drive_.imageTimes()[i]));
}

int Session::place(std::size_t i) const {
  return world_.route().stationAt(drive_.arcLengthAt(drive_.imageTimes()[i]));
}

std::vector<Pillar> walkers(const World& world, int count, std::uint64_t seed, double t, const Pose2& robot) {
  std::vector<Pillar> people;
  const Route& route = world.route();
  for (int i = 0; i < count; ++i) {
    base::Rng rng = base::Rng(seed).fork(50 + static_cast<std::uint64_t>(i));
    const double direction = rng.below(2) ? 1 : -1, speed = rng.uniform(0.5, 1.2);
    const double s = rng.uniform(0, route.length()) + direction * speed * t,
                 side = direction * rng.uniform(-0.45, -0.1);
    const Pose2 p = route.at(s);
    const double room = std::max(0.0, route.freeWidth(s, side > 0 ? 1 : -1) - 0.3);
    const double offset = std::clamp(side, -room, room);
    Pillar q;
    q.height = static_cast<float>(rng.uniform(1.58, 1.9));
    q.heading = static_cast<float>(p.heading + (direction > 0 ? 0 : std::numbers::pi));
    q.stride = static_cast<float>(std::sin(2 * std::numbers::pi * speed * t / 1.4));
    q.texture = world.library().people[rng.below(static_cast<std::uint32_t>(world.library().people.size()))];
    Eigen::Vector2d at(p.x - offset * std::sin(p.heading), p.y + offset * std::cos(p.heading));
    Eigen::Vector2d away = at - Eigen::Vector2d(robot.x, robot.y);
    if (const double d = away.norm(); d < kPersonalSpace)
      at += (d > 1e-3 ? Eigen::Vector2d(away / d) : Eigen::Vector2d::UnitX()) * (kPersonalSpace - d);
    q.centre = at.cast<float>();
    people.push_back(q);
  }
  return people;
}

std::vector<Pillar> Session::peopleAt(double t) const {
  return walkers(world_, appearance_.people, seed_, t, drive_.poseAt(t));
}

// The exposure of every image at once: it lags behind the light, so it depends on the images before.
void Session::meterAll() {
  double level = 0;
  const double lag = world_.params().sensor.exposure_lag;
  for (std::size_t i = 0; i < size(); ++i) {
    const double t = drive_.imageTimes()[i];
    const double now =
        std::log(std::max(1e-4, left_.meter(scene_, T_world_robot(i) * eyes_.left.T_robot_cam, peopleAt(t))));
    const double follow = i == 0 || lag <= 0 ? 1 : 1 - std::exp(-(t - drive_.imageTimes()[i - 1]) / lag);
    level += (now - level) * follow;
    exposures_.push_back(left_.expose(std::exp(level)));
  }
}

Shot Session::shotAt(std::size_t i, const cameras::CameraRig& rig) const {
  const double t = drive_.imageTimes()[i];
  Shot shot;
  shot.exposure = exposures_[i];
  shot.people = peopleAt(t);
  for (int k = 0; k < kExposureSteps; ++k) {
    const double at = t + shot.exposure.seconds * ((k + 0.5) / kExposureSteps - 0.5);
    shot.T_world_cam.push_back(toIsometry(drive_.poseAt(at)) * rig.T_robot_cam);
  }
  return shot;
}

types::Frame Session::frame(std::size_t i, int threads) const {
  types::Frame f;
  f.index = i;
  f.stamp = stamp(i);
  char label[48];
  std::snprintf(label, sizeof label, "session %d image %zu", appearance_.session, i);
  f.label = label;
  f.T_odom_robot = toIsometry(drive_.odometryAt(drive_.imageTimes()[i]));
  Shot shot = shotAt(i, eyes_.left);
  shot.seed = base::Rng(seed_).fork(100000 + 2 * i).bits();
  f.image = left_.render(scene_, shot, threads);
  if (right_) {
    shot = shotAt(i, *eyes_.right);
    shot.seed = base::Rng(seed_).fork(100001 + 2 * i).bits();
    f.right = right_->render(scene_, shot, threads);
  }
  return f;
}

cv::Mat renderAt(const World& world, const Appearance& appearance, const cameras::CameraRig& rig,
                 const Pose2& T_world_robot, int threads) {
  const Scene scene(world.building(), appearance, world.library(), threads);
  const Renderer renderer(rig, world.params().sensor);
  return renderAt(scene, renderer, toIsometry(T_world_robot) * rig.T_robot_cam, {}, world.params().seed,
                  threads);
}

cv::Mat renderAt(const Scene& scene, const Renderer& renderer, const Eigen::Isometry3d& T_world_cam,
                 const std::vector<Pillar>& people, std::uint64_t seed, int threads) {
  Shot shot;
  shot.T_world_cam = {T_world_cam};
  shot.people = people;
  shot.exposure = renderer.expose(renderer.meter(scene, T_world_cam, people));
  shot.seed = seed;
  return renderer.render(scene, shot, threads);
}

std::optional<types::Frame> WorldSource::next() {
  if (next_ >= session_->size()) return std::nullopt;
  return session_->frame(next_++, threads_);
}

}  // namespace engram::world
