// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/memory_report.h"

#include "common/experiment.h"
#include "engram/charts/charts.h"
#include "engram/charts/page.h"
#include "memory/paper_findings.h"

#include <algorithm>
#include <functional>
#include <map>

namespace engram::apps {
namespace {

using charts::Cell;
using charts::ChartFrame;
using charts::Curve;
using charts::Page;
using evaluation::Interval;

using Pick = std::function<const Interval&(const LabFigure&)>;

/// The paper's figure numbers of error and success for each condition.
const std::map<std::string, std::string> kPaperFigures{{"clean", "figures 9 and 10"},
                                                       {"noise", "figures 11 and 12"},
                                                       {"noise_25", "figures 13 and 14"},
                                                       {"noise_50", "figures 15 and 16"}};

charts::Estimate scaled(const Interval& i, double factor) {
  return {factor * i.value, factor * i.low, factor * i.high};
}

/// One curve a method over the updates, in the order of the methods.
std::vector<Curve> curvesOver(const std::vector<LabFigure>& figures, const std::string& condition,
                              const Pick& pick, double factor) {
  std::vector<Curve> curves;
  for (const auto& f : figures) {
    if (f.condition != condition) continue;
    if (curves.empty() || curves.back().label != f.method)
      curves.push_back({f.method, static_cast<int>(curves.size()), {}});
    curves.back().points.push_back({static_cast<double>(f.update), scaled(pick(f), factor)});
  }
  return curves;
}

void addCondition(Page& page, const MemoryReport& report, const std::string& condition) {
  page.heading("Localisation: " + inWords(condition));
  const auto chart = [&](const std::string& title, const std::string& y, const Pick& pick, bool share) {
    ChartFrame frame{title, "map update", y};
    if (share) frame.yRange = {0.0, 100.0};
    return charts::curveChart(frame, curvesOver(report.figures, condition, pick, share ? 100.0 : 1.0));
  };
  const std::string paper = " (compare " + kPaperFigures.at(condition) + " of the paper)";
  page.beginRow();
  page.figure(chart(
                  "Global: first image of a sequence", "within 1.25 places [%]",
                  [](const LabFigure& f) -> const Interval& { return f.globalSuccess; }, true),
              "Success of global localisation" + paper);
  page.figure(chart(
                  "Local: the images after it", "within 1.25 places [%]",
                  [](const LabFigure& f) -> const Interval& { return f.localSuccess; }, true),
              "Success of local localisation" + paper);
  page.figure(chart(
                  "Global: first image of a sequence", "mean error [places]",
                  [](const LabFigure& f) -> const Interval& { return f.globalError; }, false),
              "Mean error of global localisation" + paper);
  page.figure(chart(
                  "Local: the images after it", "mean error [places]",
                  [](const LabFigure& f) -> const Interval& { return f.localError; }, false),
              "Mean error of local localisation" + paper);
  page.endRow();
}

void addFinalTable(Page& page, const MemoryReport& report) {
  for (const auto& condition : conditions()) {
    std::vector<LabFigure> last;
    for (const auto& f : report.figures)
      if (f.condition == condition.name && f.update == report.lab.updates) last.push_back(f);
    page.table(tableOf(last).toPage(
        "After the last update: " + inWords(condition.name) +
            ". Success is the share within 1.25 places, by the interpolated peak and by the most "
            "probable place; in brackets the 95 % interval",
        true));
  }
}

void addFindings(Page& page, const MemoryReport& report) {
  page.table(
      tableOf(paperFindings(report.figures))
          .toPage("What the paper found, and whether we do. By mean values; the intervals are above", true));
}

void addAdvantages(Page& page, const MemoryReport& report) {
  page.table(tableOf(report.advantages)
                 .toPage("How much more often " + report.runs.front().method +
                             " is right than each other method on the same images, in percentage points, "
                             "global and "
                             "local together, after the last update. An interval that holds 0 is a tie",
                         true));
}

void addMemory(Page& page, const MemoryReport& report) {
  page.heading("What the places hold");
  std::vector<Curve> features, bytes;
  for (const MethodRun& run : report.runs) {
    const int style = static_cast<int>(bytes.size());
    bytes.push_back({run.method, style, {}});
    const bool stores = run.method.rfind("bow", 0) != 0;  // a bag has no short-term memory
    if (stores) {
      features.push_back({run.method + ", long-term", style, {}});
      features.push_back({run.method + ", short-term", style + 4, {}});
    }
    for (std::size_t u = 0; u < run.updates.size(); ++u) {
      const auto x = static_cast<double>(u + 1);
      const Holdings& h = run.updates[u].holdings;
      bytes.back().points.push_back({x, {h.bytesPerPlace / 1000}});
      if (!stores) continue;
      features[features.size() - 2].points.push_back(
          {x, {h.longTerm, h.longTerm - h.longTermSigma, h.longTerm + h.longTermSigma}});
      features.back().points.push_back(
          {x, {h.shortTerm, h.shortTerm - h.shortTermSigma, h.shortTerm + h.shortTermSigma}});
    }
  }
  std::vector<Curve> fsh, stores;
  for (Curve& c : features) {
    if (c.label.rfind("fsh,", 0) == 0) fsh.push_back(c);
    if (c.label.rfind("multi_store_2", 0) == 0) stores.push_back(c);
  }
  page.beginRow();
  page.figure(charts::curveChart({"FSH", "map update", "features a place"}, fsh),
              "Long-term and short-term features a place, mean and one sigma over the places (compare figure "
              "17 of the paper)");
  page.figure(charts::curveChart({"Multi-store", "map update", "features a place"}, stores),
              "The same for the two-store memory");
  page.figure(charts::curveChart({"Size of a place", "map update", "kB a place"}, bytes),
              "Size as stored in a map file. A bag of words keeps every view, for its geometric check");
  page.endRow();
}

void addLearning(Page& page, const MemoryReport& report) {
  charts::Table table;
  table.caption =
      "All updates together: views offered, views that were accepted with the consent of the geometry, "
      "those of them at a wrong place (more than one away), and updates of a place that followed";
  table.header = {"method", "views", "accepted", "wrong", "learnt"};
  table.rowHeads = true;
  for (const MethodRun& run : report.runs) {
    Learning sum;
    for (const auto& u : run.updates) {
      sum.views += u.learning.views;
      sum.accepted += u.learning.accepted;
      sum.wrong += u.learning.wrong;
      sum.learnt += u.learning.learnt;
    }
    table.rows.push_back(
        {run.method, Cell(sum.views, 0), Cell(sum.accepted, 0), Cell(sum.wrong, 0), Cell(sum.learnt, 0)});
  }
  page.table(table);
}

/// Figures whose method is called `prefix` and a number, over that number.
std::vector<Curve> sweepCurves(const MemoryReport& report, const std::string& prefix) {
  std::vector<Curve> curves{{"global, clean", 0, {}},
                            {"local, clean", 1, {}},
                            {"global, noise and 50 % removed", 2, {}},
                            {"local, noise and 50 % removed", 3, {}}};
  for (const auto& f : report.swept) {
    if (f.method.rfind(prefix, 0) != 0 || f.update != report.lab.updates) continue;
    const double x = std::stod(f.method.substr(prefix.size()));
    const std::size_t at = f.condition == "clean" ? 0 : 2;
    curves[at].points.push_back({x, scaled(f.globalSuccess, 100)});
    curves[at + 1].points.push_back({x, scaled(f.localSuccess, 100)});
  }
  return curves;
}

void addSweeps(Page& page, const MemoryReport& report) {
  if (report.swept.empty()) return;
  page.heading("The two thresholds of the FSH");
  page.beginRow();
  page.figure(
      charts::curveChart({"Pruning age", "prune_view [updates]", "within 1.25 places [%]"},
                         sweepCurves(report, "prune_view_")),
      "Success after the last update over the pruning age (compare figure 6 a of the paper: best at 4)");
  page.figure(
      charts::curveChart({"Long-term threshold", "ltm_threshold", "within 1.25 places [%]"},
                         sweepCurves(report, "ltm_threshold_")),
      "Success after the last update over the long-term threshold, with a floor of 40 long-term features "
      "(compare figure 6 b of the paper: 0.3 and 0.7)");
  page.endRow();
}

void addStaticPlaces(Page& page, const MemoryReport& report) {
  if (report.staticPlaces.empty()) return;
  page.heading("A robot that stands still");
  std::map<std::string, std::vector<Curve>> curves;  // by place
  for (const auto& r : report.staticPlaces) {
    auto& here = curves[r.place];
    here.push_back({r.method, static_cast<int>(here.size()), {}});
    for (std::size_t i = 0; i < r.similarities.size(); ++i)
      here.back().points.push_back({static_cast<double>(i + 2), {100 * r.similarities[i]}});
  }
  page.beginRow();
  for (const auto& [place, lines] : curves)
    page.figure(charts::curveChart({"Place: " + place, "image", "similarity [%]"}, lines),
                "Similarity of each image to the memory made from those before it (compare figure 8 of the "
                "paper)");
  page.endRow();
  page.table(
      tableOf(report.staticPlaces)
          .toPage("Mean similarity of all images to what the place remembers; days are the blocks of the "
                  "interval. The paper: 88.8 % with the FSH, 58.2 % without"));
}

void addDrives(Page& page, const MemoryReport& report) {
  page.heading("The drives");
  charts::Table table;
  table.header = {"use", "day of the world", "images", "the building"};
  for (const auto& d : report.drives.tours)
    table.rows.push_back({"update " + std::to_string(d.session), Cell(d.session, 0),
                          Cell(static_cast<double>(d.samples.size()), 0), d.weather});
  for (const auto& d : report.drives.tests)
    table.rows.push_back(
        {"test", Cell(d.session, 0), Cell(static_cast<double>(d.samples.size()), 0), d.weather});
  page.table(table);
}

}  // namespace

std::string toHtml(const MemoryReport& report) {
  Page page("Memory laboratory: how places remember");
  const auto& lab = report.lab;
  page.paragraph(
      "A robot with an omnidirectional camera drives a simulated building (" + lab.preset + ", seed " +
      std::to_string(report.seed) + ") " + std::to_string(lab.updates) +
      " times over months of changing light, furniture, posters and people. Every method makes its " +
      std::to_string(lab.places) +
      " places from the first drive and learns from the others where it finds itself and the geometry "
      "agrees. "
      "After each update " +
      std::to_string(lab.sequences) + " random sequences of " + std::to_string(lab.sequence_length) +
      " images from " + std::to_string(lab.test_days) +
      " test drives on later days, at other positions and headings, are located: the first image with no "
      "prior "
      "knowledge (global), the others by tracking (local). Intervals are 95 %, by bootstrap over stretches "
      "of "
      "the test drives.");
  page.heading("Results after the last update");
  addFinalTable(page, report);
  addFindings(page, report);
  addAdvantages(page, report);
  for (const auto& condition : conditions()) addCondition(page, report, condition.name);
  addMemory(page, report);
  addLearning(page, report);
  addSweeps(page, report);
  addStaticPlaces(page, report);
  addDrives(page, report);
  return finished(page, report.settings, report.seed, false);
}

}  // namespace engram::apps
