// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/live_config.h"

#include "engram/base/error.h"

#include <vector>

namespace engram::capture {
namespace {

/// MRPT's mark of a section that rawlog-grabber is to pass over.
constexpr const char* kNoSensor = "rawlog-grabber-ignore";

std::vector<std::string> sectionNames(const base::IniFile& ini) {
  std::vector<std::string> names;
  for (const auto& [name, section] : ini.sections()) names.push_back(name);
  return names;
}

[[noreturn]] void failMissing(const base::IniFile& ini, const std::string& name, const std::string& what) {
  const std::string nearest = base::nearestName(name, sectionNames(ini));
  throw base::ConfigError(ini.name() + ": there is no section [" + name + "], " + what +
                          (nearest.empty() ? "" : "; did you mean [" + nearest + "]?"));
}

}  // namespace

LiveConfig takeLiveConfig(base::IniFile& ini, const std::string& name, bool optional) {
  if (!optional && !ini.sections().contains(name)) failMissing(ini, name, "which is to describe the camera");
  base::IniFile alone = ini;
  for (const auto& other : sectionNames(ini))
    if (other != name) alone.take(other);

  LiveConfig live;
  base::Config config;
  config.bind(name, live.camera);
  config.read(alone);
  try {
    requireTwoCameras(live.camera);
  } catch (const base::ConfigError& e) {
    throw base::ConfigError(ini.name() + ": [" + name + "] " + e.what());
  }
  ini.take(name);
  if (const auto features = ini.take(name + ".features"))
    for (const auto& [key, value] : *features)
      if (key != kNoSensor) live.camera.features.emplace_back(key, value.text);
  if (live.camera.odometry.empty()) return live;
  const auto odometry = ini.take(live.camera.odometry);
  if (!odometry)
    failMissing(ini, live.camera.odometry, "which [" + name + "] odometry names as the sensor of odometry");
  live.odometry = *odometry;
  return live;
}

void dropSensors(base::IniFile& ini) {
  for (const auto& name : sectionNames(ini)) {
    const auto section = ini.sections().find(name);
    if (section == ini.sections().end() || !section->second.contains("driver")) continue;
    ini.take(name);
    ini.take(name + ".features");
  }
}

}  // namespace engram::capture
