// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "capture_command.h"
#include "engram/apps/config_file.h"
#include "engram/base/error.h"
#include "engram/capture/sensor_reader.h"

#include <cstdio>

namespace engram::apps {
namespace {

/// The section with our driver, when there is just one.
std::string onlyCameraOf(const base::IniFile& ini) {
  std::string found, all;
  for (const auto& [name, section] : ini.sections()) {
    const auto driver = section.find("driver");
    if (driver == section.end() || driver->second.text != capture::kGigeDriver) continue;
    all += (all.empty() ? "[" : ", [") + name + "]";
    found = name;
  }
  if (all.empty())
    throw base::Error(ini.name() + ": no section has driver = " + std::string(capture::kGigeDriver) +
                      "; give --section NAME");
  if (all != "[" + found + "]")
    throw base::Error(ini.name() + " describes " + all + "; choose one by --section NAME");
  return found;
}

std::pair<std::string, std::string> split(const std::string& assignment, const std::string& option) {
  const auto equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw UsageError(option + " '" + assignment + "': expected NAME=VALUE");
  return {assignment.substr(0, equals), assignment.substr(equals + 1)};
}

}  // namespace

void CameraOptions::declare(CLI::App& app) {
  app.add_option("config", config,
                 "Configuration with a section that describes the camera (.ini); not needed");
  app.add_option("--section", section, "Name of that section; default: the one that is a camera");
  app.add_option("--camera", camera, "Id or address of the camera; see engram-capture list")->type_name("ID");
  app.add_option("--right", rightCamera, "The same of the right camera of a stereo pair")->type_name("ID");
  app.add_option("--set", settings, "Override one key of the section: key=value (repeatable)")
      ->take_all()
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  app.add_option("--feature", features, "Set any GenICam feature of the camera: Name=value (repeatable)")
      ->take_all()
      ->allow_extra_args(false)
      ->type_name("NAME=VALUE");
  app.add_option("--plugin", plugins, "Shared library with further MRPT sensors (repeatable)")
      ->take_all()
      ->allow_extra_args(false)
      ->type_name("FILE");
}

capture::LiveConfig CameraOptions::load() const {
  capture::loadSensorPlugins(plugins);
  base::IniFile ini = config.empty() ? base::IniFile::parse("", "command line") : loadConfig(config);
  std::string name = section;
  if (name.empty()) name = config.empty() ? "camera" : onlyCameraOf(ini);
  for (const auto& assignment : settings) {
    const auto [key, value] = split(assignment, "--set");
    ini.override(name + "." + key + "=" + value);
  }
  if (!camera.empty()) ini.override(name + ".camera=" + camera);
  if (!rightCamera.empty()) ini.override(name + ".right_camera=" + rightCamera);
  capture::LiveConfig live = capture::takeLiveConfig(ini, name, config.empty());
  for (const auto& assignment : features) live.camera.features.push_back(split(assignment, "--feature"));
  return live;
}

std::string describe(const capture::CameraSettings& s) {
  char rate[40] = "";
  if (s.frameRate > 0) std::snprintf(rate, sizeof rate, ", %.4g images/s", s.frameRate);
  std::string text = std::to_string(s.width) + "x" + std::to_string(s.height) + " " + s.format + rate + ", " +
                     s.vendor + " " + s.model + " " + s.serial;
  if (!s.address.empty()) text += " at " + s.address;
  return text;
}

}  // namespace engram::apps
