// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/run_config.h"

#include "engram/apps/config_file.h"
#include "engram/base/error.h"
#include "engram/cameras/camera_import.h"
#include "engram/capture/sensor_reader.h"
#include "engram/store/map_file.h"
#include "engram/types/size_text.h"

#include <algorithm>
#include <filesystem>
#include <ostream>

namespace engram::apps {
namespace fs = std::filesystem;

namespace {

bool isSimulatorsCamera(const std::string& file) {
  const fs::path path(file);
  return path.parent_path().filename() == "cameras" && path.filename().string().ends_with("_world.ini");
}

void requireSimulatorsSize(const std::string& file, cv::Size images, const std::string& input) {
  const cv::Size size = cameras::loadCamera(file).camera->imageSize();
  if (images == size) return;
  throw base::Error(
      input + ": the images are " + types::sizeText(images) +
      ", and the configuration has the camera of the " + "simulator, " + file + " of " +
      types::sizeText(size) + ". Give the calibration of your camera with " +
      "--camera FILE (`engram-rawlog calibrate` makes one), or take fsh_mono, which needs none");
}

}  // namespace

void RunConfig::declare(CLI::App& app) {
  options.declare(app);
  app.add_option("--camera", cameraFile,
                 "Calibration, instead of [camera] file of the configuration: of Engram or MRPT "
                 "(.ini), OpenCV, ROS or EuRoC (.yaml; left.yaml,right.yaml), KITTI (calib.txt, "
                 "calib.txt:P2)")
      ->type_name("FILE");
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

/// The configuration that a map was made with. Its camera is in the map, whatever became of the file.
base::IniFile RunConfig::ofMap(const std::string& map) {
  if (map.empty()) throw UsageError("a configuration is missing: a file (.ini), or a name such as fsh_omni");
  const map::MapHeader header = store::MapFile::open(map, store::Access::kReadOnly).header();
  base::IniFile ini = base::IniFile::parse(header.parameters, "configuration of map '" + map + "'");
  if (header.camera.starts_with("[")) holdCamera(header.camera, "calibration of map '" + map + "'");
  return ini;
}

bool RunConfig::load(std::ostream& out, const std::string& map) {
  base::Config config;
  bind(config);
  const bool ownConfig = !options.file.empty();
  base::IniFile ini = ownConfig ? loadConfig(options.file) : ofMap(map);
  const base::IniFile file = ini;
  for (const auto& assignment : options.overrides) ini.override(assignment);
  if (!cameraFile.empty()) ini.override("camera.file=" + cameraFile);
  const auto isCamera = [](const std::string& s) { return s.starts_with("camera.file="); };
  cameraGiven_ =
      !cameraFile.empty() || std::any_of(options.overrides.begin(), options.overrides.end(), isCamera);
  if (cameraGiven_) camera_.reset();
  if (!liveSection.empty()) {
    capture::loadSensorPlugins(plugins);
    live = capture::takeLiveConfig(ini, liveSection);
  }
  capture::dropSensors(ini);
  config.read(ini);
  pipeline::requireEffect(ini, pipeline, "--set");
  requireEffect(file);

  if (options.dump) {
    out << dump(config);
    if (liveSection.empty()) return true;
    base::Config sensor;
    sensor.bind(liveSection, live.camera);
    out << sensor.dump();
    return true;
  }
  if (camera_) pipeline.camera.file = camera_->path();
  cameraGiven_ = cameraGiven_ || !ownConfig;
  return false;
}

void RunConfig::holdCamera(const std::string& text, const std::string& name) {
  camera_ = std::make_shared<base::HeldText>(text);
  cameraName_ = name;
  pipeline.camera.file = camera_->path();
}

std::string RunConfig::settleCamera(OfflineInput& input) {
  const std::string file = pipeline.camera.file;
  const bool simulators = isSimulatorsCamera(file) && !cameraGiven_;
  if (!input.isOpen()) return {};
  if (!cameraGiven_ && (simulators || file.empty()))
    if (const std::string own = input.calibration(pipeline.camera.stereo); !own.empty()) {
      holdCamera(own, input.path());
      return "camera: as " + input.path() + " says; --camera gives another";
    }
  const types::Frame* first = input.peek();
  if (first == nullptr) return {};
  if (simulators) requireSimulatorsSize(file, first->image.size(), input.path());
  if (!cameras::isForeignCalibration(file)) return {};
  if (!pipeline.camera.stereo)
    holdCamera(cameras::toText(cameras::importCamera(file, first->image.size())), file);
  else if (const auto rig = cameras::importStereoRig(file, first->image.size()))
    holdCamera(cameras::toText(*rig), file);
  return {};
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

/// K saw no false match from 30 inliers on, and asked for 80 itself (K-E5).
std::string RunConfig::warning() const {
  constexpr int kSafe = 30;
  if (pipeline.mapping.nodes != "views" || pipeline.stereo.min_inliers >= kSafe) return {};
  return "warning: [stereo] min_inliers = " + std::to_string(pipeline.stereo.min_inliers) +
         ": links between views that less than " + std::to_string(kSafe) + " points confirm may be false";
}

std::string RunConfig::dumpForMap() const {
  RunConfig copy = *this;
  copy.pipeline.recognise.threads = 1;  // the map does not depend on it
  if (camera_) copy.pipeline.camera.file = cameraName_;
  base::Config config;
  copy.bind(config);
  return copy.dump(config);
}

}  // namespace engram::apps
