// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/experiment.h"
#include "engram/charts/charts.h"
#include "engram/charts/page.h"
#include "views/views_report.h"

#include <algorithm>

namespace engram::apps {
namespace {

using charts::Curve;
using charts::Page;

void addSequences(Page& page, const ViewsResult& result) {
  page.table(tableOf(sessionsOf("", result.orders.front().sessions))
                 .toPage("One map of all drives, in their own order, drive by drive"));
  page.table(
      tableOf(result.orders, result.tour)
          .toPage("The same drives in random orders (K: the same map with only minor variation). Error: "
                  "root mean square over all views along all drives, after one alignment"));
}

void addRepair(Page& page, const RepairRun& repair) {
  page.table(tableOf(repair).toPage(
      "Repair of that map: days later, furniture moved, both eyes covered again and again"));
  page.note("The paper's run: 20 covers, 650 views and 2,676 links within the drive, few to older views.");
}

void addLifelong(Page& page, const ViewsResult& result) {
  const auto chart = [&](const std::string& title, const std::string& yLabel, auto value) {
    std::vector<Curve> curves;
    for (std::size_t r = 0; r < result.lifelong.size(); ++r) {
      const LifelongRun& run = result.lifelong[r];
      Curve curve{run.rule == "none" ? "nothing is forgotten" : "at most " + run.rule + " views",
                  static_cast<int>(r),
                  {}};
      for (std::size_t k = 0; k < run.sessions.size(); ++k)
        curve.points.push_back({static_cast<double>(k + 1), {value(run, k)}});
      curves.push_back(std::move(curve));
    }
    return charts::curveChart({title, "session", yLabel}, curves);
  };
  page.beginRow();
  page.figure(chart("Views", "views in the map",
                    [](const LifelongRun& run, std::size_t k) { return double(run.sessions[k].views); }),
              "Size of the map over the sessions");
  page.figure(
      chart("File", "size of the map file [MB]",
            [](const LifelongRun& run, std::size_t k) { return double(run.sessions[k].bytes) / 1e6; }),
      "The map file; the path of the robot is in it and grows by 0.1 KB a view");
  page.endRow();
  page.beginRow();
  page.figure(chart("Time", "CPU a view [ms]",
                    [](const LifelongRun& run, std::size_t k) { return run.sessions[k].msPerView; }),
              "What an image costs that becomes a view");
  page.figure(chart("Localisation", "images located right [%]",
                    [](const LifelongRun& run, std::size_t k) {
                      return k == 0 ? std::numeric_limits<double>::quiet_NaN() : 100 * run.located[k].share();
                    }),
              "Images of each session in the map of the sessions before it, each image by itself");
  page.endRow();
}

void addKappas(Page& page, const ViewsResult& result) {
  page.table(
      kappaTable(result.kappas).toPage("Views that a neighbourhood keeps (K-39; the paper's table is lost)"));
}

void addOffsets(Page& page, const ViewsResult& result) {
  std::vector<Curve> curves;
  for (const auto& cell : result.offsets) {
    const std::string label = std::to_string(std::lround(cell.angle * 180 / M_PI)) + " degrees";
    auto curve = std::find_if(curves.begin(), curves.end(), [&](const Curve& c) { return c.label == label; });
    if (curve == curves.end()) {
      curves.push_back({label, static_cast<int>(curves.size()), {}});
      curve = curves.end() - 1;
    }
    curve->points.push_back({cell.distance, {100.0 * cell.recognised / std::max(1, cell.tried)}});
  }
  page.figure(charts::curveChart({"Recognition rate", "distance [m]", "recognised [%]"}, curves),
              "Views so far ahead of a reference view and turned against it (compare figure 1 of the paper)");
}

void addSpots(Page& page, const ViewsResult& result) {
  page.table(tableOf(result.spots).toPage("One spot that changes in the ways of figure 4 of the paper"));
}

}  // namespace

std::string toHtml(const ViewsResult& result, const std::string& settings, std::uint64_t seed) {
  Page page("Lifelong maps of stereo views");
  page.paragraph(
      "The experiments of Konolige and Bowman (2009) on simulated drives with a stereo camera (seed " +
      std::to_string(seed) +
      "). The wheels bridge what visual odometry cannot, but in the repair drive, which has none.");
  page.heading("Drives stitched to one map");
  addSequences(page, result);
  page.heading("Repair");
  addRepair(page, result.repair);
  page.heading("Many sessions");
  addLifelong(page, result);
  page.heading("How many views a neighbourhood needs");
  addKappas(page, result);
  page.heading("What is recognised");
  addOffsets(page, result);
  addSpots(page, result);
  return finished(page, settings, seed, true);
}

}  // namespace engram::apps
