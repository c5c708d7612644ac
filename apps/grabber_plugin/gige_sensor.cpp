// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "gige_sensor.h"

#include "engram/base/error.h"
#include "engram/base/standard_descriptors.h"
#include "engram/capture/live_config.h"
#include "engram/capture/live_source.h"

#include <mrpt/config/CConfigFileBase.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <chrono>
#include <iostream>
#include <sstream>

namespace engram::apps {

IMPLEMENTS_GENERIC_SENSOR(EngramGigECamera, engram::apps)

namespace {

// When it is loaded, before rawlog-grabber opens its rawlog: messages must not get into that.
[[maybe_unused]] const bool descriptorsAreOpen = (base::openStandardDescriptors(), true);

/// Keys of MRPT that its base class reads under other names than ours.
bool isMrptsOwn(const std::string& key) { return key == "sensorLabel" || key == "enabled"; }

/// The section and its `.features`, for our strict reader.
base::IniFile toIni(const mrpt::config::CConfigFileBase& config, const std::string& section) {
  std::ostringstream text;
  for (const std::string& name : {section, section + ".features"}) {
    std::vector<std::string> keys;
    config.getAllKeys(name, keys);
    text << "[" << name << "]\n";
    for (const auto& key : keys)
      if (!isMrptsOwn(key)) text << key << " = " << config.read_string(name, key, "") << "\n";
  }
  return base::IniFile::parse(text.str(), "rawlog-grabber");
}

}  // namespace

EngramGigECamera::~EngramGigECamera() {
  if (queue_) queue_->close();  // a thread may wait for room in it
}

void EngramGigECamera::loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                                 const std::string& section) {
  base::IniFile ini = toIni(config, section);
  ini.override(section + ".odometry=");  // rawlog-grabber runs that sensor itself
  params_ = capture::takeLiveConfig(ini, section).camera;
  if (!config.keyExists(section, "sensorLabel")) m_sensorLabel = params_.sensor_label;
}

void EngramGigECamera::initialize() {
  const auto choice = capture::queueFor(params_, true);
  queue_ = std::make_unique<capture::BoundedQueue<types::Frame>>(choice.capacity, choice.whenFull);
  grabber_ = std::make_unique<capture::GigeGrabber>(
      params_, [queue = queue_.get()](types::Frame&& frame) { queue->push(std::move(frame)); });
  m_state = ssWorking;
}

void EngramGigECamera::doProcess() {
  while (auto frame = queue_->pop(std::chrono::seconds(0))) hand(std::move(*frame));
  for (const auto& notice : grabber_->takeNotices())
    std::cerr << "[" << m_sensorLabel << "] " << notice << "\n";
  const std::string failure = grabber_->failure();
  if (failure.empty()) return;
  m_state = ssError;
  throw base::Error(failure);
}

void EngramGigECamera::hand(types::Frame&& frame) {
  const auto stamp = mrpt::Clock::fromDouble(frame.stamp);
  if (frame.right.empty()) {
    auto object = mrpt::obs::CObservationImage::Create();
    object->timestamp = stamp;
    object->sensorLabel = m_sensorLabel;
    object->image = mrpt::img::CImage(frame.image, mrpt::img::SHALLOW_COPY);
    appendObservation(object);
    return;
  }
  auto object = mrpt::obs::CObservationStereoImages::Create();
  object->timestamp = stamp;
  object->sensorLabel = m_sensorLabel;
  object->imageLeft = mrpt::img::CImage(frame.image, mrpt::img::SHALLOW_COPY);
  object->imageRight = mrpt::img::CImage(frame.right, mrpt::img::SHALLOW_COPY);
  object->hasImageRight = true;
  appendObservation(object);
}

}  // namespace engram::apps

namespace {

/// Loading the library is all it takes.
[[maybe_unused]] const bool registered = [] {
  engram::apps::EngramGigECamera::doRegister();
  return true;
}();

}  // namespace
