// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "views/views_command.h"

#include "engram/apps/program.h"
#include "engram/base/atomic_file.h"
#include "engram/base/config.h"
#include "views/views_report.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <ostream>

namespace engram::apps {
namespace fs = std::filesystem;

namespace {

/// config/view_map.ini but for the camera; a test holds the two together.
pipeline::PipelineParams viewMap() {
  pipeline::PipelineParams p;
  p.mapping.nodes = "views";
  p.camera.stereo = true;
  p.extractor.upright = true;
  p.memory.memory = "static";
  p.recognise.scorer = "vocabulary_tree";
  p.recognise.verified_scores = 15;
  p.recognise.accept_inliers = 30;
  p.recognise.closure_inliers = 30;
  p.recognise.sure_inliers = 80;
  p.recognise.accept_similarity = 0.1;
  p.recognise.closure_similarity = 0.1;
  p.posegraph.planar = false;
  p.posegraph.window_places = 60;
  return p;
}

}  // namespace

void ViewsCommand::declare(CLI::App& command) { options_.declare(command); }

std::string ViewsCommand::readConfig() {
  pipeline_ = viewMap();
  world_.drive.spacing = 0.1;  // an image is about 6 a second
  world_.drive.turn_spacing = 4 * M_PI / 180;
  world_.change.people = 2;
  world_.sensor.samples = 1;
  if (options_.quick) {
    views_.building = "tiny";
    views_.sequences = 2;
    views_.orders = 1;
    views_.covers = 2;
    views_.sessions = 2;
    views_.sudden = "2";
    views_.kappas = "2";
    views_.kappa_sessions = 2;
    views_.poses = 1;
    views_.sequence_scale = views_.lifelong_scale = 0.4;
    world_.drive.laps = 0.5;
    pipeline_.views.sure_inliers = pipeline_.recognise.sure_inliers = 40;  // small images have less features
  }
  base::Config config;
  config.bind("views_world", views_);
  config.bind("change", world_.change);
  config.bind("drive", world_.drive);
  config.bind("sensor", world_.sensor);
  pipeline_.bind(config);
  base::IniFile ini = options_.config.empty() ? base::IniFile::parse("", "command line")
                                              : base::IniFile::load(options_.config);
  for (const auto& assignment : options_.overrides) ini.override(assignment);
  config.read(ini);
  auto& camera = pipeline_.camera.file;
  const auto& sections = ini.sections();
  const auto given = sections.find("camera");
  const bool ofFile =
      given != sections.end() && given->second.contains("file") && given->second.at("file").origin != "--set";
  if (ofFile && !camera.empty() && fs::path(camera).is_relative())
    camera = (fs::path(options_.config).parent_path() / camera).lexically_normal().string();
  return config.dump();
}

int ViewsCommand::run(std::ostream& out, std::ostream& err) {
  const std::string settings = readConfig();
  if (options_.dump) {
    out << settings;
    return kOk;
  }
  claimFolder(
      options_,
      settings + "\n# seed = " + std::to_string(options_.seed) + (options_.quick ? ", quick\n" : "\n"),
      {"sessions.csv", "offsets.csv", "index.html"});
  world_.seed = options_.seed;
  ViewsWorld experiments(
      views_, world_, pipeline_,
      {options_.folder, options_.seed, options_.threadsInUse(), options_.quiet ? nullptr : &err});
  const ViewsResult result = experiments.run();
  writeResults(result, settings);
  if (!options_.quiet)
    out << toText(result) << "report: " << (fs::path(options_.folder) / "index.html").string() << "\n";
  return kOk;
}

void ViewsCommand::writeResults(const ViewsResult& result, const std::string& settings) const {
  const fs::path folder = options_.folder;
  const auto write = [&](const char* name, const std::string& text) {
    base::writeText((folder / name).string(), text, true);
  };
  write("sessions.csv", sessionsCsv(result));
  write("offsets.csv", offsetsCsv(result));
  write("index.html", toHtml(result, settings, options_.seed));
  nlohmann::json json = toJson(result);
  json["seed"] = options_.seed;
  writeJson(options_.json, json);
}

}  // namespace engram::apps
