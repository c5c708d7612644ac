// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tours/tours_command.h"

#include "common/methods.h"
#include "engram/apps/program.h"
#include "engram/base/atomic_file.h"
#include "engram/base/config.h"
#include "tours/tours_report.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <ostream>

namespace engram::apps {
namespace fs = std::filesystem;

/// 36 tours in two months (D-10): little changes from one to the next, much on a few days. The paper does not
/// say how much its office changed.
ToursCommand::ToursCommand() {
  world_.change.poster_share = 0.03;
  world_.change.furniture_share = 0.05;
  world_.change.door_share = 0.2;
  world_.change.sudden_sessions = "10,19,28";
  world_.change.sudden_share = 0.35;
  world_.change.days = 2.14;  // whole days, rounded down: 60 over 35 tours
  world_.drive.spacing = 0.35;
}

void ToursCommand::declare(CLI::App& command) { options_.declare(command); }

std::string ToursCommand::readConfig() {
  if (options_.quick) {  // the same steps in a small building
    tours_ = {"tiny", 4, 6, tours_.learn, tours_.few_matches};
    world_.change.sudden_sessions = "3";
    world_.drive.spacing = 0.8;
  }
  base::IniFile ini = options_.config.empty() ? base::IniFile::parse("", "command line")
                                              : base::IniFile::load(options_.config);
  for (const auto& assignment : options_.overrides) ini.override(assignment);
  base::Config config;
  config.bind("tours", tours_);
  config.bind("change", world_.change);
  config.bind("drive", world_.drive);
  pipeline_.bind(config);
  config.read(ini);
  world_.seed = options_.seed;
  return config.dump();
}

int ToursCommand::run(std::ostream& out, std::ostream& err) {
  const std::string settings = readConfig();
  if (options_.dump) {
    out << settings;
    return kOk;
  }
  claimFolder(options_, settings + "\n# seed = " + std::to_string(options_.seed) + "\n",
              {"tours.csv", "report.html"});
  ToursLab lab(tours_, world_, pipeline_,
               {options_.folder, options_.seed, options_.threadsInUse(), options_.quiet ? nullptr : &err});
  const auto runs = lab.run(touredMethods(pipeline_));
  const auto figures = figuresOf(runs, tours_.few_matches);
  base::writeText((fs::path(options_.folder) / "tours.csv").string(), toCsv(runs, tours_.few_matches), true);
  base::writeText((fs::path(options_.folder) / "report.html").string(),
                  toHtml(figures, runs, tours_, settings, options_.seed), true);
  writeJson(options_.json, {{"seed", options_.seed},
                            {"few_matches", tours_.few_matches},
                            {"tours", toJson(figures)},
                            {"paper",
                             {{"adaptive", {{"failure_rate", 0.015}, {"share_under_35", 0.24}}},
                              {"static", {{"failure_rate", 0.035}, {"share_under_35", 0.43}}}}}});
  if (!options_.quiet)
    out << toText(figures, runs, tours_.few_matches)
        << "report: " << (fs::path(options_.folder) / "report.html").string() << "\n";
  return kOk;
}

}  // namespace engram::apps
