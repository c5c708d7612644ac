// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/memory_command.h"

#include "common/methods.h"
#include "engram/pipeline/perception.h"
#include "memory/paper_findings.h"

#include <algorithm>

namespace engram::apps {
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

/// Those of `all` with these names, in their order; without names all.
std::vector<Method> chosen(const std::vector<Method>& all, const std::vector<std::string>& names) {
  if (names.empty()) return all;
  std::vector<Method> methods;
  for (const auto& name : names) {
    const auto at = std::find_if(all.begin(), all.end(), [&](const Method& m) { return m.name == name; });
    if (at == all.end()) {
      std::string known;
      for (const auto& m : all) known += " " + m.name;
      throw UsageError("--methods: there is no '" + name + "'; there are" + known);
    }
    methods.push_back(*at);
  }
  return methods;
}

std::string summaryOf(const MemoryReport& report) {
  std::vector<LabFigure> last;
  for (const auto& f : report.figures)
    if (f.update == report.lab.updates) last.push_back(f);
  std::string text = line("After update %d, %% within %.2f places [95 %% interval]:\n", report.lab.updates,
                          kSuccessDistance);
  text += tableOf(last).toText();
  text += tableOf(paperFindings(report.figures)).toText();
  if (!report.staticPlaces.empty()) text += toText(report.staticPlaces);
  return text;
}

Findings findingsOf(const MemoryReport& report) {
  Findings findings;
  findings.files = {{"results.csv", tableOf(report.figures).toCsv()}};
  if (!report.swept.empty()) findings.files.push_back({"sweeps.csv", tableOf(report.swept).toCsv()});
  findings.files.push_back({"report.html", toHtml(report)});
  findings.figures = {{"seed", report.seed},
                      {"results", tableOf(report.figures).toJson()},
                      {"sweeps", tableOf(report.swept).toJson()},
                      {"advantages", tableOf(report.advantages).toJson()},
                      {"findings", tableOf(paperFindings(report.figures)).toJson()},
                      {"static_place", tableOf(report.staticPlaces).toJson()}};
  findings.summary = summaryOf(report);
  findings.report = "report.html";
  return findings;
}

}  // namespace

std::string MemoryCommand::description() const {
  return "How places remember: FSH, short- and long-term stores, bag of words, static, replace, over months "
         "of "
         "change";
}

std::string MemoryCommand::examples() const {
  return "  engram-eval memory --out lab --json lab.json\n"
         "  engram-eval memory --out lab_quick --quick\n"
         "  engram-eval memory --out lab_7 --seed 7 --set fsh.prune_view=3\n";
}

void MemoryCommand::declareMore(CLI::App& command) {
  command
      .add_option("--methods", names_,
                  "Only these, separated by commas; the first is compared with the others. No sweeps then")
      ->delimiter(',');
}

void MemoryCommand::configure(base::Config& config) {
  // The protocol of the papers for every method: the motion model is F eq (7), and the sensor model F eq (9)
  // to (11) has no similarity below which an image says nothing. Such a bound would favour small memories, as
  // the similarity of F eq (8) is a share of the memory.
  pipeline_.belief.advance = "none";
  pipeline_.belief.new_place_similarity = 0.0;
  if (options().quick) shrink(lab_, staticPlace_);
  config.bind("memory_lab", lab_);
  config.bind("static_place", staticPlace_);
  pipeline_.bind(config);
}

void MemoryCommand::check() {
  const world::Eyes eyes = world::presetEyes("omni");
  pipeline_.verify = pipeline::withOptics(pipeline_.verify, &eyes.left);
  methods_ = chosen(comparedMethods(pipeline_, lab_.bow_words), names_);
}

Findings MemoryCommand::measure(const Workplace& place, const std::string& settings) {
  MemoryLab lab(lab_, pipeline_, place);
  lab.record();
  MemoryReport report;
  report.runs = lab.run(methods_, conditions(), "runs");
  report.figures = figuresOf(report.runs, lab.sequences(), lab_.sequence_length);
  report.advantages = advantagesOfFirst(report.runs, lab.sequences(), lab_.sequence_length);
  if (names_.empty() && !options().quick) {
    const std::vector<Condition> extremes{conditions().front(), conditions().back()};
    report.swept = figuresOf(lab.run(sweptMethods(pipeline_), extremes, "sweeps"), lab.sequences(),
                             lab_.sequence_length);
  }
  if (names_.empty()) report.staticPlaces = staticPlace(staticPlace_, lab_.preset, pipeline_, place);
  report.drives = lab.drives();
  report.lab = lab_;
  report.settings = settings;
  report.seed = place.seed;
  return findingsOf(report);
}

}  // namespace engram::apps
