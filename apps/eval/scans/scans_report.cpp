// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scans/scans_report.h"

#include "common/experiment.h"
#include "engram/charts/charts.h"
#include "engram/charts/page.h"

#include <Eigen/Eigenvalues>

#include <cmath>

namespace engram::apps {
namespace {

using charts::Curve;
using charts::Page;

/// The 95 % ellipse of a position.
Curve ellipseOf(const DrawnScan& scan, int style) {
  constexpr double kBound = 2.4477;  // of two degrees of freedom
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(scan.cov);
  Curve curve{"", style, {}};
  for (int k = 0; k <= 24; ++k) {
    const double a = 2 * M_PI * k / 24;
    const Eigen::Vector2d p = scan.position + kBound * axes.eigenvectors() *
                                                  axes.eigenvalues().cwiseMax(0).cwiseSqrt().cwiseProduct(
                                                      Eigen::Vector2d(std::cos(a), std::sin(a)));
    curve.points.push_back({p.x(), {p.y()}});
  }
  return curve;
}

std::string ellipses(const MapPicture& picture, const std::string& title) {
  Curve ours{"references", 0, {}}, truth{"truth", 1, {}};
  std::vector<Curve> paths;
  for (const DrawnScan& scan : picture.scans) {
    ours.points.push_back({scan.position.x(), {scan.position.y()}});
    truth.points.push_back({scan.truth.x(), {scan.truth.y()}});
  }
  paths = {ours, truth};
  for (const DrawnScan& scan : picture.scans)
    if (scan.cov.trace() > 0) paths.push_back(ellipseOf(scan, 2));
  if (paths.size() > 2) paths[2].label = "95 % ellipses";
  return charts::pathChart({title, "x [m]", "y [m]"}, paths);
}

/// All points of all references; every so many, so that the page stays readable.
std::string overlay(const MapPicture& picture, const std::string& title) {
  constexpr std::size_t kMost = 6000;
  std::size_t all = 0;
  for (const DrawnScan& scan : picture.scans) all += scan.points.size();
  const std::size_t every = 1 + all / kMost;
  Curve points{"points", 3, {}}, poses{"references", 0, {}};
  std::size_t k = 0;
  for (const DrawnScan& scan : picture.scans) {
    poses.points.push_back({scan.position.x(), {scan.position.y()}});
    for (const Eigen::Vector2d& p : scan.points)
      if (k++ % every == 0 && (p - scan.position).norm() < 8) points.points.push_back({p.x(), {p.y()}});
  }
  return charts::pathChart({title, "x [m]", "y [m]"}, {poses}, {points});
}

void addMap(Page& page, const ScansResult& result) {
  const ScanRun& filter = result.world.runs.front();
  page.table(tableOf(result.world.runs)
                 .toPage(line("A drive of %.0f m: room, corridor, room and back (V: 126 references, 8,333 "
                              "points, up to 206 of "
                              "one). Errors are of the references' positions, after one alignment, before "
                              "the first closure and "
                              "at the end",
                              result.world.length)));
  page.beginRow();
  for (const MapPicture& picture : filter.pictures)
    page.figure(ellipses(picture, "image " + std::to_string(picture.image)),
                line("References with what is not known of them, error %.3f m (V figure 3)", picture.ate));
  page.endRow();
  page.beginRow();
  if (filter.pictures.size() > 1)
    page.figure(overlay(filter.pictures[filter.pictures.size() - 2], "before the closure"),
                "All points of all references before the loop closes");
  page.figure(overlay(filter.pictures.back(), "at the end"), "And at the end (V figure 5)");
  page.endRow();
  page.figure(charts::histogram({"Points of a reference", "points", "references"},
                                {{"references", 0, filter.pointsOf}}, 16),
              "How many points references have (V figure 4)");
}

void addFilter(Page& page, const ScansResult& result) {
  Curve nees{"mean over the runs", 0, {}}, low{"95 % band", 1, {}}, high{"", 1, {}};
  for (const NeesStep& step : result.nees.steps) {
    nees.points.push_back({step.way, {step.nees}});
    low.points.push_back({step.way, {result.nees.low}});
    high.points.push_back({step.way, {result.nees.high}});
  }
  page.figure(
      charts::curveChart({"Consistency", "way [m]", "NEES of the robot"}, {nees, low, high}),
      line("Simulated measurements, %d runs: %.0f %% of the images in the band. The loop closes in the "
           "last metres",
           result.nees.runs, 100 * result.nees.inside()));
  page.table(tableOf(result.sizes).toPage("The filter against the graph on the same simulated measurements"));
  Curve ekf{"ekf_scans", 0, {}}, graph{"ceres", 1, {}};
  for (const SizeFigures& s : result.sizes) {
    ekf.points.push_back({double(s.references), {s.ekfMs}});
    graph.points.push_back({double(s.references), {s.graphMs}});
  }
  page.figure(charts::curveChart({"Time", "reference scans", "CPU an image [ms]"}, {ekf, graph}),
              "Where the filter becomes the slower one (V-12)");
}

void addWindow(Page& page, const WindowFigures& w) {
  charts::Table table{
      "Matching of references that an edge joins: in the window of the prediction, and by descriptors "
      "alone",
      {"", "CPU a pair [ms]", "matches", "of these in agreement [%]"},
      {{"window", charts::Cell(w.windowMs, 3), charts::Cell(w.windowMatches, 0),
        charts::Cell(100 * w.windowInliers, 1)},
       {"descriptors alone", charts::Cell(w.fullMs, 3), charts::Cell(w.fullMatches, 0),
        charts::Cell(100 * w.fullInliers, 1)}}};
  page.table(table);
}

nlohmann::json bySize(const std::vector<SizeFigures>& sizes, double SizeFigures::*member) {
  nlohmann::json json = nlohmann::json::object();
  for (const SizeFigures& s : sizes) json[std::to_string(s.references)] = s.*member;
  return json;
}

double meanOf(const NeesFigures& nees) {
  double sum = 0;
  for (const NeesStep& step : nees.steps) sum += step.nees;
  return sum / std::max<double>(1, static_cast<double>(nees.steps.size()));
}

}  // namespace

ResultTable tableOf(const std::vector<ScanRun>& runs) {
  using R = ScanRun;
  Columns<R> c;
  c.add("back_end", &R::backEnd).json().csv().page("Back-end").text("back-end", 10);
  c.add("images", &R::images).json().csv().page("Images").text("images", -7);
  c.add("reference_scans", &R::references).json().csv().page("References").text("references", -11);
  c.add("points", &R::points).json().csv().page("Points").text("points", -8);
  c.add("recognised", &R::recognised).json().csv().page("Matched images").text("matched", -9);
  c.add("refused", &R::refused).json().csv().page("Refused").text("refused", -9);
  c.add("closures", &R::closures).json().csv().page("Closures").text("closures", -9);
  c.add("ate_open_m", &R::ateOpen)
      .json()
      .csv(4)
      .page("Error before [m]", fixed(3))
      .text("open [m]", -10, fixed(3));
  c.add("ate_closed_m", &R::ateClosed)
      .json()
      .csv(4)
      .page("Error at the end [m]", fixed(3))
      .text("closed [m]", -11, fixed(3));
  c.add("ms_per_image", &R::msPerImage).json().page("CPU an image [ms]", fixed(1)).text("ms", -7, fixed(1));
  c.add("back_end_ms", &R::relaxMs).json().page("of these, back-end [ms]", fixed(2));
  return c.table(runs);
}

ResultTable tableOf(const std::vector<SizeFigures>& sizes) {
  using S = SizeFigures;
  Columns<S> c;
  c.add("reference_scans", &S::references).json().csv().page("References").text("references", 12);
  c.add("ekf_ms", &S::ekfMs).json().csv(3).page("Filter [ms]", fixed(3)).text("ekf [ms]", -10, fixed(3));
  c.add("graph_ms", &S::graphMs).json().csv(3).page("Graph [ms]", fixed(3)).text("graph [ms]", -11, fixed(3));
  c.add("ekf_ate_m", &S::ekfAte)
      .json()
      .csv(4)
      .page("Filter, error [m]", fixed(3))
      .text("ekf [m]", -9, fixed(3));
  c.add("graph_ate_m", &S::graphAte)
      .json()
      .csv(4)
      .page("Graph, error [m]", fixed(3))
      .text("graph [m]", -10, fixed(3));
  return c.table(sizes);
}

nlohmann::json toJson(const ScansResult& result) {
  const ScanRun& filter = result.world.runs.front();
  const WindowFigures& w = result.world.window;
  return {{"way_m", result.world.length},
          {"reference_scans", filter.references},
          {"points", filter.points},
          {"ate_open_m", filter.ateOpen},
          {"ate_closed_m", filter.ateClosed},
          {"nees_inside_95", result.nees.inside()},
          {"nees_mean", meanOf(result.nees)},
          {"ekf_ms", bySize(result.sizes, &SizeFigures::ekfMs)},
          {"graph_ms", bySize(result.sizes, &SizeFigures::graphMs)},
          {"runs", tableOf(result.world.runs).toJson()},
          {"sizes", tableOf(result.sizes).toJson()},
          {"window",
           {{"pairs", w.pairs},
            {"window_ms", w.windowMs},
            {"full_ms", w.fullMs},
            {"window_matches", w.windowMatches},
            {"full_matches", w.fullMatches},
            {"window_inlier_share", w.windowInliers},
            {"full_inlier_share", w.fullInliers}}}};
}

std::string toText(const ScansResult& result) {
  const WindowFigures& w = result.world.window;
  return tableOf(result.world.runs).toText() + tableOf(result.sizes).toText() +
         line("NEES: %.0f %% of the images in the 95 %% band of %d runs, mean %.2f of 3\n",
              100 * result.nees.inside(), result.nees.runs, meanOf(result.nees)) +
         line(
             "window: %.2f ms, %.0f matches, %.0f %% in agreement; descriptors alone: %.2f ms, %.0f, %.0f "
             "%%\n",
             w.windowMs, w.windowMatches, 100 * w.windowInliers, w.fullMs, w.fullMatches,
             100 * w.fullInliers);
}

std::string toHtml(const ScansResult& result, const std::string& settings, std::uint64_t seed) {
  Page page("Visual scans with distinguishable points");
  page.paragraph(
      "The experiment of Bertolli, Jensfelt and Christensen (2006) on a simulated drive with a stereo "
      "camera and wheels that drift (seed " +
      std::to_string(seed) + ").");
  page.heading("The map");
  addMap(page, result);
  page.heading("The filter");
  addFilter(page, result);
  page.heading("Matching");
  addWindow(page, result.world.window);
  return finished(page, settings, seed, true);
}

}  // namespace engram::apps
