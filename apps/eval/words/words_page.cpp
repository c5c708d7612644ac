// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/experiment.h"
#include "engram/charts/charts.h"
#include "engram/charts/page.h"
#include "words/words_report.h"

#include <algorithm>

namespace engram::apps {
namespace {

using charts::Cell;
using charts::Curve;
using charts::Page;

Cell whole(int number) { return Cell(static_cast<double>(number), 0); }

/// "5.2" with "(4.1)" behind it.
Cell meanAndStd(double mean, double deviation) {
  Cell cell(mean, 1);
  cell.detail = "(" + Cell(deviation, 1).text + ")";
  return cell;
}

void addMappingTable(Page& page, const WordsWorldResult& result) {
  charts::Table table = mappingTable(result).toPage(
      "Mapping. Images: those that the rule of 0.5 m or 30 degrees uses. Joined: images put to a place that "
      "was there already. Closures: edges to a place that the graph had no short way to. Trajectory errors "
      "are root mean squares after alignment: of the odometry alone, of the map as it grew without any "
      "relaxation, and of that same map relaxed once by each relaxer",
      true);
  for (std::size_t r = 0; r < table.rows.size(); ++r) markBestOfRow(table, r, charts::Best::kSmallest);
  page.table(table);
}

Curve curveOf(const std::string& label, int style, const MappingRun::Path& path) {
  Curve curve{label, style, {}};
  for (const auto& p : path) curve.points.push_back({p.x(), {p.y()}});
  return curve;
}

void addPaths(Page& page, const WordsWorldResult& result, const WordsPlan& plan) {
  for (const auto& run : result.mapping) {
    const auto drive = std::find_if(plan.drives.begin(), plan.drives.end(),
                                    [&](const PlannedDrive& d) { return d.name == run.building; });
    page.heading("Map: " + run.building);
    page.paragraph(drive->about);
    Curve right{"true closure", 2, {}}, wrong{"false closure", 4, {}};
    for (const auto& c : run.closures)
      (c.right ? right : wrong).points.push_back({c.position.x(), {c.position.y()}});
    std::vector<Curve> marks;
    for (const Curve& c : {right, wrong})
      if (!c.points.empty()) marks.push_back(c);
    page.beginRow();
    const Curve truth = curveOf("truth", 0, run.truth);
    page.figure(
        charts::pathChart(
            {"Without relaxation", "x [m]", "y [m]"},
            {truth, curveOf("odometry", 3, run.odometry), curveOf("map as it grew", 1, run.before)}),
        "The robot's way by odometry, and by the map before any relaxation (compare figure 5, top, of "
        "the paper)");
    page.figure(charts::pathChart({"Relaxed", "x [m]", "y [m]"},
                                  {truth, curveOf("map, relaxed by ceres", 1, run.relaxed)}, marks),
                "The same map relaxed, with the closures where the robot was (compare figure 5, bottom)");
    page.endRow();
    page.table(closureTable({{run}, {}}).toPage("All closures of " + run.building));
  }
}

void addLocalisationTable(Page& page, const WordsWorldResult& result) {
  charts::Table table = localisationTable(result).toPage(
      "Global localisation, mean and standard deviation. Trials: images until one was accepted. Trackings: "
      "images in a row after it that were accepted at the right place. Wrong: accepted images at a wrong "
      "place. Never: attempts that found nothing before the drive ended");
  table.rows.push_back({"paper, indoor", "Gaussians", whole(100), meanAndStd(5, 4), meanAndStd(5, 3), "", "",
                        whole(327), whole(190), whole(115)});
  table.rows.push_back({"paper, outdoor", "Gaussians", whole(100), meanAndStd(2, 1), meanAndStd(12, 10), "",
                        "", whole(531), whole(230), whole(644)});
  page.table(table);
}

void addEnds(Page& page, const WordsWorldResult& result) {
  page.table(endsTable(result).toPage(
      "What ended the tracking, of the attempts that found their place (the paper: the filter usually goes "
      "on to be right, and geometry refuses)"));
}

void addDistributions(Page& page, const WordsWorldResult& result, const WordsPlan& plan) {
  for (const auto& setting : plan.settings) {
    std::vector<charts::Distribution> trials, trackings;
    for (const auto& run : result.localisation) {
      if (run.setting != setting.name) continue;
      const int style = static_cast<int>(trials.size());
      trials.push_back({run.transition, style, {}});
      trackings.push_back({run.transition, style, {}});
      for (const Attempt& a : run.attempts) {
        if (!a.located) continue;
        trials.back().values.push_back(a.trials);
        trackings.back().values.push_back(a.trackings);
      }
    }
    page.beginRow();
    page.figure(
        charts::cumulativeChart({"Trials, " + setting.name, "images until accepted", "attempts [%]"}, trials),
        "Trials in the setting " + setting.name + " (" + setting.about + "); left is better");
    page.figure(
        charts::cumulativeChart({"Trackings, " + setting.name, "images in a row", "attempts [%]"}, trackings),
        "Trackings in the setting " + setting.name + "; right is better");
    page.endRow();
  }
}

}  // namespace

std::string toHtml(const WordsWorldResult& result, const WordsPlan& plan, const WordsWorldParams& params,
                   const std::string& settings, std::uint64_t seed) {
  Page page("Words, odometry and geometry: mapping and localisation");
  page.paragraph("The experiments of Angeli, Doncieux, Meyer and Filliat (2009) on simulated drives (seed " +
                 std::to_string(seed) +
                 "). A robot with an ordinary camera and odometry drives its tour, and goes on into the next "
                 "round without "
                 "being told. A place counts as right when the robot is within " +
                 Cell(params.right_within, 1).text + " m of it.");
  page.heading("Mapping");
  addMappingTable(page, result);
  page.note(
      "The paper's run: 209 images used, 7 joined to places that were there (the paper calls these "
      "closures), none wrong, 202 places, 178 s for a drive of 310 s.");
  page.heading("Global localisation");
  page.paragraph(
      "The map is made from the first round. " + std::to_string(params.attempts) +
      " times an image of the second one is drawn, every place is equally likely, and the images that follow "
      "are shown until one is accepted; then as long as each is accepted at the right place.");
  addLocalisationTable(page, result);
  for (const Transition& t : transitions()) page.note(t.name + ": " + t.meaning + ".");
  addEnds(page, result);
  addDistributions(page, result, plan);
  addPaths(page, result, plan);
  return finished(page, settings, seed, true);
}

}  // namespace engram::apps
