// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "views/views_command.h"

#include "views/views_report.h"

namespace engram::apps {

std::string ViewsCommand::description() const {
  return "Lifelong maps of stereo views: stitched drives, repair, fifty sessions, kappa";
}

std::string ViewsCommand::examples() const { return "  engram-eval views --out views --json views.json\n"; }

void ViewsCommand::configure(base::Config& config) {
  pipeline_ = shippedPipeline("view_map.ini");
  world_.seed = options().seed;
  world_.drive.spacing = 0.1;  // an image is about 6 a second
  world_.drive.turn_spacing = 4 * M_PI / 180;
  world_.change.people = 2;
  world_.sensor.samples = 1;
  if (options().quick) {
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
  config.bind("views_world", views_);
  config.bind("change", world_.change);
  config.bind("drive", world_.drive);
  config.bind("sensor", world_.sensor);
  pipeline_.bind(config);
}

Findings ViewsCommand::measure(const Workplace& place, const std::string& settings) {
  const ViewsResult result = ViewsWorld(views_, world_, pipeline_, place).run();
  Findings findings;
  findings.files = {{"sessions.csv", tableOf(sessionsOf(result)).toCsv()},
                    {"offsets.csv", tableOf(result.offsets).toCsv()},
                    {"index.html", toHtml(result, settings, place.seed)}};
  findings.figures = toJson(result);
  findings.figures["seed"] = place.seed;
  findings.summary = toText(result);
  findings.report = "index.html";
  return findings;
}

}  // namespace engram::apps
