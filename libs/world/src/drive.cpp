// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/drive.h"

#include "engram/base/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace engram::world {
namespace {

constexpr double kStep = 0.05;      // [m] of the route's curve
constexpr double kRounding = 1.4;   // [m] of curve over which a corner is rounded
constexpr double kTimeStep = 0.02;  // [s]
constexpr double kMargin = 0.22;    // [m] the robot keeps from walls
constexpr double kTurnRate = 0.8;   // [rad/s] on the spot

double wrap(double a) { return std::remainder(a, 2 * std::numbers::pi); }

Pose2 blend(const Pose2& a, const Pose2& b, double share) {
  return {a.x + (b.x - a.x) * share, a.y + (b.y - a.y) * share,
          wrap(a.heading + wrap(b.heading - a.heading) * share)};
}

// Mean over a window of a closed list; twice is a smooth curve of bounded curvature.
std::vector<Eigen::Vector2d> smooth(const std::vector<Eigen::Vector2d>& in, int half) {
  const int n = static_cast<int>(in.size());
  std::vector<Eigen::Vector2d> out(in.size());
  for (int i = 0; i < n; ++i) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int k = -half; k <= half; ++k) sum += in[static_cast<std::size_t>(((i + k) % n + n) % n)];
    out[static_cast<std::size_t>(i)] = sum / (2 * half + 1);
  }
  return out;
}

std::vector<Eigen::Vector2d> walkPolygon(const std::vector<Eigen::Vector2d>& corners) {
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d a = corners[i], b = corners[(i + 1) % corners.size()];
    const int n = std::max(1, static_cast<int>(std::lround((b - a).norm() / kStep)));
    for (int k = 0; k < n; ++k) points.push_back(a + (b - a) * (static_cast<double>(k) / n));
  }
  return points;
}

// A smooth random function of arc length with unit variance: three waves.
class Wander {
 public:
  explicit Wander(base::Rng rng) {
    for (int i = 0; i < 3; ++i) {
      wave_[i] = 2 * std::numbers::pi / rng.uniform(4.0, 14.0);
      phase_[i] = rng.uniform(0, 2 * std::numbers::pi);
    }
  }
  double at(double s) const {
    double sum = 0;
    for (int i = 0; i < 3; ++i) sum += std::sin(wave_[i] * s + phase_[i]);
    return sum * std::sqrt(2.0 / 3.0);
  }

 private:
  double wave_[3], phase_[3];
};

}  // namespace

void DriveParams::describe(base::Params& p) {
  p.add("spacing", spacing, "distance between images [m]", {0.05, 10});
  p.addDegrees("turn_spacing", turn_spacing, "angle between images when turning on the spot [deg]", {1, 180});
  p.add("speed", speed, "of the robot [m/s]", {0.05, 3});
  p.add("lateral", lateral, "wander to both sides of the route, one sigma [m]", {0, 0.5});
  p.addDegrees("heading", heading, "wander of the heading, one sigma [deg]", {0, 30});
  p.add("laps", laps, "rounds of a tour without a stop", {0.1, 100});
  p.add("odometry_distance", odometry_distance, "noise along the motion after 1 m [m]", {0, 1});
  p.add("odometry_lateral", odometry_lateral, "noise across the motion after 1 m [m]", {0, 1});
  p.addDegrees("odometry_heading", odometry_heading, "noise of the heading after 1 m [deg]", {0, 45});
  p.addDegrees("odometry_turn", odometry_turn, "noise of the heading after turning 1 rad [deg]", {0, 45});
  p.add("odometry_scale", odometry_scale, "error of the wheel radius, one sigma over drives", {0, 0.3});
  p.add("odometry_rate", odometry_rate, "readings of the wheels [Hz]", {0.1, 200});
}

Route::Route(const Plan& plan) {
  const int half = static_cast<int>(kRounding / kStep / 4);
  const auto points = smooth(smooth(walkPolygon(plan.route), half), half);
  std::vector<double> at{0};
  for (std::size_t i = 0; i < points.size(); ++i)
    at.push_back(at.back() + (points[(i + 1) % points.size()] - points[i]).norm());
  length_ = at.back();
  stations_ = std::max(1, static_cast<int>(std::lround(length_)));
  const int n = static_cast<int>(std::lround(length_ / kStep));
  std::size_t segment = 0;
  for (int i = 0; i < n; ++i) {  // equal steps of arc length
    const double s = length_ * i / n;
    while (at[segment + 1] < s) ++segment;
    const double share = (s - at[segment]) / std::max(1e-9, at[segment + 1] - at[segment]);
    const Eigen::Vector2d p =
        points[segment] + (points[(segment + 1) % points.size()] - points[segment]) * share;
    curve_.push_back({p.x(), p.y(), 0});
  }
  for (int i = 0; i < n; ++i) {
    const Pose2 &a = curve_[static_cast<std::size_t>((i + n - 1) % n)],
                &b = curve_[static_cast<std::size_t>((i + 1) % n)];
    curve_[static_cast<std::size_t>(i)].heading = std::atan2(b.y - a.y, b.x - a.x);
  }
  for (const auto& p : curve_)
    for (const int side : {1, -1}) {
      double w = 0;
      for (; w < 1.0; w += 0.02) {
        const double x = p.x - side * w * std::sin(p.heading), y = p.y + side * w * std::cos(p.heading);
        const char c =
            plan.at(static_cast<int>(std::floor(x / plan.cell)), static_cast<int>(std::floor(y / plan.cell)));
        if (!isFloor(c) && c != '+') break;
      }
      (side > 0 ? left_ : right_).push_back(w);
    }
}

Pose2 Route::at(double s) const {
  const auto n = curve_.size();
  const double f = (s / length_ - std::floor(s / length_)) * static_cast<double>(n);
  const std::size_t i = std::min(n - 1, static_cast<std::size_t>(f));
  return blend(curve_[i], curve_[(i + 1) % n], f - static_cast<double>(i));
}

int Route::stationAt(double s) const {
  const int k = static_cast<int>(std::lround(s / pitch())) % stations_;
  return k < 0 ? k + stations_ : k;
}

double Route::freeWidth(double s, int side) const {
  const auto n = static_cast<int>(curve_.size());
  const int i = static_cast<int>(std::lround((s / length_ - std::floor(s / length_)) * n));
  double width = 1;
  for (int k = -8; k <= 8; ++k)  // what comes within 0.4 m counts too
    width = std::min(width, (side > 0 ? left_ : right_)[static_cast<std::size_t>(((i + k) % n + n) % n)]);
  return width;
}

Drive::Drive(const Route& route, const DriveParams& params, DriveKind kind, std::uint64_t seed)
    : params_(params) {
  base::validate(params);
  const base::Rng rng(seed);
  base::Rng choice = rng.fork(1);
  if (kind == DriveKind::kTour) {
    follow(route, 0, params_.laps * route.length(), rng.fork(2), 0, 1);
  } else {
    const double start = route.length() * choice.uniform(0.15, 0.5), end = start + 0.7 * route.length();
    const double bias = (choice.below(2) ? 1 : -1) * 0.22;
    follow(route, start, end, rng.fork(2), bias, 2);
    turnTo(route.at(end).heading + std::numbers::pi);
    follow(route, end, end - 0.45 * route.length(), rng.fork(2), bias, 2);
  }
  takeImages();
  readWheels(rng.fork(4));
}

void Drive::follow(const Route& route, double from, double to, base::Rng rng, double bias, double wobble) {
  const Wander side(rng.fork(1)), turn(rng.fork(2));
  const int direction = to > from ? 1 : -1;
  const auto place = [&](double s) {
    Pose2 p = route.at(s);
    const double wanted = bias + params_.lateral * side.at(s);
    const double offset = std::clamp(wanted, -std::max(0.0, route.freeWidth(s, -1) - kMargin),
                                     std::max(0.0, route.freeWidth(s, 1) - kMargin));
    p.x -= offset * std::sin(p.heading), p.y += offset * std::cos(p.heading);
    return p;
  };
  const auto mean = [&](double s) {  // the clamp has steps; the robot has not
    Pose2 sum{0, 0, 0};
    constexpr int n = 3;
    for (int k = -n; k <= n; ++k) {
      const Pose2 p = place(s + 0.07 * k);
      sum.x += p.x / (2 * n + 1), sum.y += p.y / (2 * n + 1);
    }
    return sum;
  };
  double t = states_.empty() ? 0 : states_.back().t + kTimeStep;
  double speed = 0.1;
  for (double s = from; direction * (to - s) > 0; t += kTimeStep) {
    Pose2 p = mean(s);
    const Pose2 q = mean(s + direction * 0.05);
    const double bend = std::abs(wrap(route.at(s + direction * 0.4).heading - route.at(s).heading));
    p.heading = wrap(std::atan2(q.y - p.y, q.x - p.x) + params_.heading * wobble * turn.at(s));
    states_.push_back({t, p, s});
    const double wanted = params_.speed / (1 + 0.8 * bend);
    speed += std::clamp(wanted - speed, -0.8 * kTimeStep, 0.5 * kTimeStep);
    s += direction * speed * kTimeStep;
  }
  if (states_.empty()) throw base::Error("the route is too short to drive");
}

void Drive::turnTo(double heading) {
  const State start = states_.back();
  const double angle = wrap(heading - start.pose.heading);
  const int n = static_cast<int>(std::abs(angle) / (kTurnRate * kTimeStep));
  for (int i = 1; i <= n; ++i) {
    State next = start;
    next.t += i * kTimeStep;
    next.pose.heading = wrap(start.pose.heading + angle * i / n);
    states_.push_back(next);
  }
}

void Drive::takeImages() {
  double driven = params_.spacing, turned = 0;  // the first state gives an image
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (i > 0) {
      const Pose2 d = between(states_[i - 1].pose, states_[i].pose);
      driven += std::hypot(d.x, d.y);
      turned += std::abs(d.heading) * (std::hypot(d.x, d.y) < 1e-6 ? 1 : 0);  // on the spot
    }
    if (driven < params_.spacing && turned < params_.turn_spacing) continue;
    imageTimes_.push_back(states_[i].t);
    driven = driven >= params_.spacing ? std::fmod(driven, params_.spacing) : 0;
    turned = 0;
  }
}

void Drive::readWheels(base::Rng rng) {
  const double scale = 1 + params_.odometry_scale * rng.normal();
  Pose2 pose;
  odometry_.push_back({0, pose});
  Pose2 before = states_.front().pose;
  const double step = 1 / params_.odometry_rate;
  for (double t = step; t < duration() + step; t += step) {
    const Pose2 now = poseAt(std::min(t, duration()));
    Pose2 d = between(before, now);
    const double distance = std::hypot(d.x, d.y), angle = std::abs(d.heading);
    const double root = std::sqrt(distance);
    d.x = d.x * scale + params_.odometry_distance * root * rng.normal();
    d.y = d.y * scale + params_.odometry_lateral * root * rng.normal();
    d.heading += std::sqrt(params_.odometry_heading * params_.odometry_heading * distance +
                           params_.odometry_turn * params_.odometry_turn * angle) *
                 rng.normal();
    pose = compose(pose, d);
    odometry_.push_back({std::min(t, duration()), pose});
    before = now;
  }
}

Drive::State Drive::stateAt(double t) const {
  const double f = std::clamp(t / kTimeStep, 0.0, static_cast<double>(states_.size() - 1));
  const std::size_t i = std::min(states_.size() - 1, static_cast<std::size_t>(f)),
                    j = std::min(states_.size() - 1, i + 1);
  const double share = f - static_cast<double>(i);
  const State &a = states_[i], &b = states_[j];
  return {t, blend(a.pose, b.pose, share), a.s + (b.s - a.s) * share};
}

Pose2 Drive::poseAt(double t) const { return stateAt(t).pose; }
double Drive::arcLengthAt(double t) const { return stateAt(t).s; }

Pose2 Drive::odometryAt(double t) const {
  const auto after = std::lower_bound(odometry_.begin(), odometry_.end(), t,
                                      [](const Tick& k, double v) { return k.t < v; });
  if (after == odometry_.begin()) return odometry_.front().pose;
  if (after == odometry_.end()) return odometry_.back().pose;
  const auto before = after - 1;
  return blend(before->pose, after->pose, (t - before->t) / (after->t - before->t));
}

}  // namespace engram::world
