// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/exporters/charts.h"
#include "engram/exporters/page.h"
#include "views/views_report.h"

#include <algorithm>

namespace engram::apps {
namespace {

using exporters::Cell;
using exporters::Curve;
using exporters::Page;

Cell whole(double number) { return Cell(number, 0); }

int total(const std::vector<ViewSession>& sessions, int ViewSession::*member) {
  int sum = 0;
  for (const auto& s : sessions) sum += s.*member;
  return sum;
}

void addSequences(Page& page, const ViewsResult& result) {
  const OrderedRun& first = result.orders.front();
  exporters::Table drives;
  drives.caption = "One map of all drives, in their own order, drive by drive";
  drives.header = {"drive",     "images", "views added",      "links",       "false",    "weak made",
                   "weak left", "parts",  "views in the map", "ms an image", "ms a view"};
  for (std::size_t k = 0; k < first.sessions.size(); ++k) {
    const ViewSession& s = first.sessions[k];
    drives.rows.push_back({whole(static_cast<double>(k + 1)), whole(s.frames), whole(s.viewsAdded),
                           whole(s.links), whole(s.falseLinks), whole(s.weakMade), whole(s.weakLeft),
                           whole(s.parts), whole(s.views), Cell(1000 * s.seconds / std::max(1, s.frames), 1),
                           Cell(s.msPerView, 1)});
  }
  page.table(drives);
  exporters::Table orders;
  orders.caption =
      "The same drives in random orders (K: the same map with only minor variation). Error: root mean square "
      "over all views along all drives, after one alignment";
  orders.header = {"order", "views", "parts", "weak left", "false links", "error [m]", "of a round [%]"};
  for (const OrderedRun& run : result.orders) {
    std::string order;
    for (const int k : run.order) {
      if (!order.empty()) order += ' ';
      order.append(std::to_string(k + 1));
    }
    const ViewSession& end = run.sessions.back();
    orders.rows.push_back({order, whole(end.views), whole(end.parts), whole(end.weakLeft),
                           whole(total(run.sessions, &ViewSession::falseLinks)), Cell(run.ate, 3),
                           Cell(100 * run.ate / result.tour, 2)});
  }
  page.table(orders);
}

void addRepair(Page& page, const RepairRun& repair) {
  exporters::Table table;
  table.caption = "Repair of that map: days later, furniture moved, both eyes covered again and again";
  table.header = {"covers",       "views added",     "links within the drive", "links to older views",
                  "false links",  "weak links made", "weak links left",        "located before",
                  "located after"};
  const auto share = [](const LocatedShare& l) {
    return std::to_string(l.right) + " of " + std::to_string(l.images);
  };
  table.rows.push_back({whole(static_cast<double>(repair.covers.size())), whole(repair.session.viewsAdded),
                        whole(repair.linksWithin), whole(repair.linksAcross),
                        whole(repair.session.falseLinks), whole(repair.session.weakMade),
                        whole(repair.session.weakLeft), share(repair.before), share(repair.after)});
  page.table(table);
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
    return exporters::curveChart({title, "session", yLabel}, curves);
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
  exporters::Table table;
  table.caption = "Views that a neighbourhood keeps (K-39; the paper's table is lost)";
  table.header = {"kappa", "views in the map", "located [%]", "CPU a view [ms]", "map [MB]", "error [m]"};
  for (const auto& run : result.kappas) {
    LocatedShare all;
    for (const auto& l : run.located) {
      all.images += l.images;
      all.right += l.right;
    }
    const ViewSession& end = run.sessions.back();
    table.rows.push_back({run.rule, whole(end.views), Cell(100 * all.share(), 1), Cell(end.msPerView, 1),
                          Cell(static_cast<double>(end.bytes) / 1e6, 2), Cell(run.ate, 3)});
  }
  page.table(table);
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
  page.figure(exporters::curveChart({"Recognition rate", "distance [m]", "recognised [%]"}, curves),
              "Views so far ahead of a reference view and turned against it (compare figure 1 of the paper)");
}

void addSpots(Page& page, const ViewsResult& result) {
  exporters::Table table;
  table.caption = "One spot that changes in the ways of figure 4 of the paper";
  table.header = {"what changes", "views kept at the end", "most at once", "looks that matched"};
  for (const auto& spot : result.spots)
    table.rows.push_back({spot.name + ": " + spot.about, whole(spot.views.back()),
                          whole(*std::max_element(spot.views.begin(), spot.views.end())),
                          std::to_string(spot.matched) + " of " + std::to_string(spot.looks)});
  page.table(table);
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
  page.heading("What made this page");
  page.paragraph("Seed " + std::to_string(seed) +
                 ". The same command gives the same figures, but for processor times.");
  page.preformatted(settings, "configuration");
  return page.html();
}

}  // namespace engram::apps
