// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scans/scans_command.h"

#include "engram/base/error.h"
#include "engram/base/text.h"
#include "scans/scans_report.h"

#include <sstream>

namespace engram::apps {
namespace {

std::vector<int> sizesOf(const std::string& text) {
  std::vector<int> sizes;
  std::istringstream in(text);
  for (std::string item; std::getline(in, item, ',');) {
    const bool whole = !item.empty() && item.size() < 6 &&
                       item.find_first_not_of("0123456789") == std::string::npos && std::stoi(item) >= 10;
    if (!whole)
      throw base::ConfigError("[scans_world] sizes: " + base::quoted(item) +
                              " is no whole number from 10 on");
    sizes.push_back(std::stoi(item));
  }
  return sizes;
}

}  // namespace

std::string ScansCommand::description() const {
  return "Visual scans in an augmented-state filter: a loop, its ellipses and overlays, NEES, filter or "
         "graph";
}

std::string ScansCommand::examples() const { return "  engram-eval scans --out scans --json scans.json\n"; }

void ScansCommand::configure(base::Config& config) {
  pipeline_ = shippedPipeline("visual_scans.ini");
  world_.seed = options().seed;
  world_.drive.spacing = 0.1;
  world_.drive.turn_spacing = 5 * M_PI / 180;
  world_.drive.laps = 1.1;  // on over its beginning
  world_.change.people = 0;
  world_.sensor.samples = 1;
  if (options().quick) {
    scans_.scale = 0.5;
    scans_.seeds = 20;
    scans_.sizes = "20,50";
    scans_.building = "tiny";
    pipeline_.views.sure_inliers = 25;  // small images have less features
    pipeline_.scans.thin = 20;
  }
  config.bind("scans_world", scans_);
  config.bind("change", world_.change);
  config.bind("drive", world_.drive);
  config.bind("sensor", world_.sensor);
  pipeline_.bind(config);
}

Findings ScansCommand::measure(const Workplace& place, const std::string& settings) {
  base::validate(scans_);
  const std::vector<int> sizes = sizesOf(scans_.sizes);
  ScansResult result;
  result.world = runScansWorld(scans_, world_, pipeline_, place);
  result.nees = measureNees(scans_.seeds, place.seed);
  for (const int references : sizes) result.sizes.push_back(compareAt(references, place.seed));
  Findings findings;
  findings.files = {{"runs.csv", tableOf(result.world.runs).toCsv()},
                    {"sizes.csv", tableOf(result.sizes).toCsv()},
                    {"index.html", toHtml(result, settings, place.seed)}};
  findings.figures = toJson(result);
  findings.figures["seed"] = place.seed;
  findings.summary = toText(result);
  findings.report = "index.html";
  return findings;
}

}  // namespace engram::apps
