// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A sensor of MRPT for the tests: odometry of a robot that drives a circle, as a function of the host's
// clock.
#include <mrpt/hwdrivers/CGenericSensor.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <cmath>
#include <stdexcept>

namespace engram::testing {

/// Keys: speed [m/s], turn [rad/s], fail_after [readings] (0: never).
class CircleOdometry final : public mrpt::hwdrivers::CGenericSensor {
  DEFINE_GENERIC_SENSOR(CircleOdometry)

 public:
  void doProcess() override {
    if (failAfter_ > 0 && readings_ >= failAfter_) throw std::runtime_error("the cable is out");
    ++readings_;
    auto odometry = mrpt::obs::CObservationOdometry::Create();
    odometry->timestamp = mrpt::Clock::now();
    odometry->sensorLabel = m_sensorLabel;
    const double t = std::fmod(mrpt::Clock::toDouble(odometry->timestamp), 1e5);
    const double yaw = turn_ * t;
    odometry->odometry = {speed_ / turn_ * std::sin(yaw), speed_ / turn_ * (1.0 - std::cos(yaw)), yaw};
    appendObservation(odometry);
  }

 protected:
  void loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                 const std::string& section) override {
    speed_ = config.read_double(section, "speed", 0.5);
    turn_ = config.read_double(section, "turn", 0.2);
    failAfter_ = config.read_int(section, "fail_after", 0);
    if (turn_ == 0.0) throw std::runtime_error("turn must not be zero");
  }

 private:
  double speed_ = 0.5, turn_ = 0.2;
  int failAfter_ = 0, readings_ = 0;
};

IMPLEMENTS_GENERIC_SENSOR(CircleOdometry, engram::testing)

}  // namespace engram::testing

namespace {

[[maybe_unused]] const bool registered = [] {
  engram::testing::CircleOdometry::doRegister();
  return true;
}();

}  // namespace
