// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/run_config.h"

#include "engram/apps/config_file.h"
#include "engram/capture/sensor_reader.h"

#include <ostream>

namespace engram::apps {

void RunConfig::declare(CLI::App& app) {
  options.declare(app);
  app.add_option("--camera", cameraFile, "Calibration file, instead of [camera] file of the configuration");
  app.add_option("--live", liveSection,
                 "Section of the configuration that describes a live GigE Vision camera")
      ->type_name("SECTION");
  app.add_option("--plugin", plugins, "Shared library with further MRPT sensors, for --live (repeatable)")
      ->take_all()
      ->allow_extra_args(false)
      ->type_name("FILE");
}

void RunConfig::bind(base::Config& config) {
  config.bind("source", source);
  pipeline.bind(config);
}

bool RunConfig::load(std::ostream& out) {
  base::Config config;
  bind(config);
  base::IniFile ini = loadConfig(options.file);
  const base::IniFile file = ini;
  for (const auto& assignment : options.overrides) ini.override(assignment);
  if (!cameraFile.empty()) ini.override("camera.file=" + cameraFile);
  if (!liveSection.empty()) {
    capture::loadSensorPlugins(plugins);
    live = capture::takeLiveConfig(ini, liveSection);
  }
  capture::dropSensors(ini);
  config.read(ini);
  pipeline::requireEffect(ini, pipeline, "--set");
  requireEffect(file);

  if (!options.dump) return false;
  out << dump(config);
  if (liveSection.empty()) return true;
  base::Config sensor;
  sensor.bind(liveSection, live.camera);
  out << sensor.dump();
  return true;
}

/// The file by itself: what the command line changes is not the file's fault.
void RunConfig::requireEffect(base::IniFile file) const {
  if (!liveSection.empty()) capture::takeLiveConfig(file, liveSection);
  capture::dropSensors(file);
  RunConfig alone;
  base::Config config;
  alone.bind(config);
  config.read(file);
  pipeline::requireEffect(file, alone.pipeline);
}

std::string RunConfig::dump(const base::Config& config) const {
  return config.dump([this](const std::string& section, const std::string& key) {
    return pipeline::whyInert(pipeline, section, key);
  });
}

std::string RunConfig::dumpForMap() const {
  RunConfig copy = *this;
  copy.pipeline.recognise.threads = 1;  // the map does not depend on it
  base::Config config;
  copy.bind(config);
  return copy.dump(config);
}

}  // namespace engram::apps
