// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tours/tours_command.h"

#include "common/methods.h"
#include "engram/pipeline/perception.h"
#include "tours/tours_report.h"

namespace engram::apps {

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

std::string ToursCommand::description() const {
  return "Two months of tours: adaptive memories against a static one";
}

std::string ToursCommand::examples() const { return "  engram-eval tours --out tours --json tours.json\n"; }

void ToursCommand::configure(base::Config& config) {
  if (options().quick) {  // the same steps in a small building
    tours_ = {"tiny", 4, 6, tours_.learn, tours_.few_matches};
    room_.images = 12;
    room_.rearranged_every = 5;
    world_.change.sudden_sessions = "3";
    world_.drive.spacing = 0.8;
  }
  world_.seed = options().seed;
  config.bind("tours", tours_);
  config.bind("room", room_);
  config.bind("change", world_.change);
  config.bind("drive", world_.drive);
  pipeline_.bind(config);
}

Findings ToursCommand::measure(const Workplace& place, const std::string& settings) {
  const world::Eyes eyes = world::presetEyes("omni");
  pipeline_.verify = pipeline::withOptics(pipeline_.verify, &eyes.left);
  ToursLab lab(tours_, world_, pipeline_, place);
  const auto runs = lab.run(touredMethods(pipeline_));
  const int few = tours_.few_matches;
  const auto figures = figuresOf(runs, few);
  const auto inTheRoom = room(room_, tours_.preset, pipeline_, place);
  Findings findings;
  findings.files = {{"tours.csv", toCsv(runs, few)},
                    {"report.html", toHtml(figures, runs, inTheRoom, tours_, settings, place.seed)}};
  findings.figures = {{"seed", place.seed},
                      {"few_matches", few},
                      {"tours", tableOf(figures, few).toJson()},
                      {"room", tableOf(inTheRoom).toJson()},
                      {"paper",
                       {{"adaptive", {{"failure_rate", 0.015}, {"share_under_35", 0.24}}},
                        {"static", {{"failure_rate", 0.035}, {"share_under_35", 0.43}}},
                        {"room",
                         {{"adaptive", {{"mean_matched", 98.8}, {"sd_matched", 18.7}}},
                          {"static", {{"mean_matched", 45.2}, {"sd_matched", 25.4}}}}}}}};
  findings.summary = toText(figures, runs, few) + toText(inTheRoom);
  findings.report = "report.html";
  return findings;
}

}  // namespace engram::apps
