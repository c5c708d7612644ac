// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/memory_command.h"

#include "common/methods.h"
#include "engram/apps/program.h"
#include "engram/base/atomic_file.h"
#include "engram/base/config.h"
#include "engram/base/error.h"
#include "memory/lab_figures.h"
#include "memory/memory_report.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <ostream>

namespace engram::apps {
namespace fs = std::filesystem;
namespace {

/// The small version: the same steps on a small building.
void shrink(MemoryLabParams& lab, StaticPlaceParams& place) {
  lab.preset = "tiny";
  lab.places = 20;
  lab.updates = 3;
  lab.test_days = 1;
  lab.sequences = 20;
  lab.sequence_length = 5;
  lab.bow_words = 200;
  place.days = 2;
  place.images = 6;
}

std::string percent(const evaluation::Interval& i) {
  char text[64];
  std::snprintf(text, sizeof text, "%5.1f [%5.1f, %5.1f]", 100 * i.value, 100 * i.low, 100 * i.high);
  return text;
}

void printTable(const std::vector<LabFigure>& figures, int update, std::ostream& out) {
  char line[256];
  std::snprintf(line, sizeof line, "After update %d, %% within %.2f places [95 %% interval]:\n", update,
                kSuccessDistance);
  out << line;
  std::snprintf(line, sizeof line, "%-17s %-9s %-22s %-22s %s\n", "method", "condition", "global", "local",
                "mean error [places]   kB a place");
  out << line;
  for (const auto& f : figures) {
    if (f.update != update) continue;
    std::snprintf(line, sizeof line, "%-17s %-9s %-22s %-22s %5.2f [%5.2f, %5.2f]  %7.1f\n", f.method.c_str(),
                  f.condition.c_str(), percent(f.globalSuccess).c_str(), percent(f.localSuccess).c_str(),
                  f.error.value, f.error.low, f.error.high, f.bytesPerPlace / 1000);
    out << line;
  }
}

}  // namespace

void MemoryCommand::declare(CLI::App& command) {
  options_.declare(command);
  command
      .add_option("--methods", methods_,
                  "Only these, separated by commas; the first is compared with the others. No sweeps then")
      ->delimiter(',');
}

std::vector<Method> MemoryCommand::chosenMethods() const {
  const auto all = comparedMethods(pipeline_, lab_.bow_words);
  if (methods_.empty()) return all;
  std::vector<Method> chosen;
  for (const auto& name : methods_) {
    const auto at = std::find_if(all.begin(), all.end(), [&](const Method& m) { return m.name == name; });
    if (at == all.end()) {
      std::string names;
      for (const auto& m : all) names += " " + m.name;
      throw UsageError("--methods: there is no '" + name + "'; there are" + names);
    }
    chosen.push_back(*at);
  }
  return chosen;
}

std::string MemoryCommand::readConfig() {
  // The protocol of the papers for every method: the motion model is F eq (7), and the sensor model F eq (9)
  // to (11) has no similarity below which an image says nothing. Such a bound would favour small memories, as
  // the similarity of F eq (8) is a share of the memory.
  pipeline_.belief.advance = "none";
  pipeline_.belief.new_place_similarity = 0.0;
  if (options_.quick) shrink(lab_, staticPlace_);
  base::IniFile ini = options_.config.empty() ? base::IniFile::parse("", "command line")
                                              : base::IniFile::load(options_.config);
  for (const auto& assignment : options_.overrides) ini.override(assignment);
  base::Config config;
  config.bind("memory_lab", lab_);
  config.bind("static_place", staticPlace_);
  pipeline_.bind(config);
  config.read(ini);
  return config.dump();
}

int MemoryCommand::run(std::ostream& out, std::ostream& err) {
  const std::string settings = readConfig();
  if (options_.dump) {
    out << settings;
    return kOk;
  }
  const std::vector<Method> methods = chosenMethods();
  claimFolder(options_, settings + "\n# seed = " + std::to_string(options_.seed) + "\n",
              {"results.csv", "sweeps.csv", "report.html"});
  const Workplace place{options_.folder, options_.seed, options_.threadsInUse(),
                        options_.quiet ? nullptr : &err};
  MemoryLab lab(lab_, pipeline_, place);
  lab.record();
  const auto runs = lab.run(methods, conditions(), "runs");
  const auto figures = figuresOf(runs, lab.sequences(), lab_.sequence_length);

  std::vector<MethodRun> sweeps;
  std::vector<StaticPlaceResult> places;
  if (methods_.empty()) {
    const std::vector<Condition> extremes{conditions().front(), conditions().back()};
    if (!options_.quick) sweeps = lab.run(sweptMethods(pipeline_), extremes, "sweeps");
    places = staticPlace(staticPlace_, lab_.preset, pipeline_, place);
  }
  const MemoryReport report{figures,
                            runs,
                            figuresOf(sweeps, lab.sequences(), lab_.sequence_length),
                            advantagesOfFirst(runs, lab.sequences(), lab_.sequence_length),
                            places,
                            lab.drives(),
                            lab_,
                            settings,
                            options_.seed};
  writeResults(report);
  if (!options_.quiet) {
    printTable(figures, lab_.updates, out);
    if (!places.empty()) out << toText(places);
    out << "report: " << (fs::path(options_.folder) / "report.html").string() << "\n";
  }
  return kOk;
}

void MemoryCommand::writeResults(const MemoryReport& report) const {
  const fs::path folder = options_.folder;
  base::writeText((folder / "results.csv").string(), toCsv(report.figures), true);
  if (!report.swept.empty()) base::writeText((folder / "sweeps.csv").string(), toCsv(report.swept), true);
  base::writeText((folder / "report.html").string(), toHtml(report), true);
  writeJson(options_.json, {{"seed", report.seed},
                            {"results", toJson(report.figures)},
                            {"sweeps", toJson(report.swept)},
                            {"advantages", toJson(report.advantages)},
                            {"static_place", toJson(report.staticPlaces)}});
}

}  // namespace engram::apps
