// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tours/tours_report.h"

#include "common/experiment.h"
#include "engram/charts/charts.h"
#include "engram/charts/page.h"

#include <algorithm>

namespace engram::apps {
namespace {

using charts::Cell;
using charts::Curve;

charts::Table comparison(const std::vector<ToursFigure>& figures, int few) {
  charts::Table table =
      tableOf(figures, few)
          .toPage(
              "All images of all tours but the first, with 95 % intervals by bootstrap over tours. Failure: "
              "the place with the most matched points is neither the last place that the robot passed nor "
              "the next one",
              true);
  table.rows.push_back({"paper, adaptive", Cell(1.5, 1), "", Cell(24.0, 0), "", "", ""});
  table.rows.push_back({"paper, static", Cell(3.5, 1), "", Cell(43.0, 0), "", "", ""});
  return table;
}

/// One curve a method over the tours.
template <class Value>
std::vector<Curve> overTours(const std::vector<ToursRun>& runs, Value value) {
  std::vector<Curve> curves;
  for (const ToursRun& run : runs) {
    curves.push_back({run.method, static_cast<int>(curves.size()), {}});
    for (const TourRecord& tour : run.tours)
      curves.back().points.push_back({static_cast<double>(tour.tour), {value(run, tour)}});
  }
  return curves;
}

/// One curve a method over the images of the room.
std::vector<Curve> overImages(const std::vector<RoomResult>& room,
                              const std::vector<int> RoomResult::*values) {
  std::vector<Curve> curves;
  for (const RoomResult& result : room) {
    curves.push_back({result.method, static_cast<int>(curves.size()), {}});
    for (std::size_t i = 0; i < (result.*values).size(); ++i)
      curves.back().points.push_back(
          {static_cast<double>(i + 2), {static_cast<double>((result.*values)[i])}});
  }
  return curves;
}

void addRoom(charts::Page& page, const std::vector<RoomResult>& room) {
  page.heading("One room, changed by hand");
  charts::Table table = tableOf(room).toPage(
      "Points of each image that match the long-term memory of one place, while posters and furniture change "
      "from "
      "image to image",
      true);
  table.rows.push_back({"paper, adaptive", Cell(98.8, 1), Cell(18.7, 1), "", "", ""});
  table.rows.push_back({"paper, static", Cell(45.2, 1), Cell(25.4, 1), "", "", ""});
  page.table(table);
  page.beginRow();
  page.figure(
      charts::curveChart({"Matched points", "image", "points"}, overImages(room, &RoomResult::matched)),
      "Points matched with the long-term memory");
  page.figure(
      charts::curveChart({"Long-term memory", "image", "features"}, overImages(room, &RoomResult::longTerm)),
      "Long-term features (compare figure 5 of the paper)");
  page.figure(charts::curveChart({"Short-term memory", "image", "features"},
                                 overImages(room, &RoomResult::shortTerm)),
              "Short-term features (compare figure 5 of the paper)");
  page.endRow();
}

double failureShare(const ToursRun& run, const TourRecord& tour) {
  const TourPlaces truth = run.truth();
  const auto failed = std::count_if(tour.queries.begin(), tour.queries.end(), [&](const TourQuery& q) {
    return q.winner < 0 || !truth.brackets(q.winner, q.arc);
  });
  return 100.0 * static_cast<double>(failed) /
         std::max<double>(1.0, static_cast<double>(tour.queries.size()));
}

std::vector<charts::Distribution> matchedPoints(const std::vector<ToursRun>& runs) {
  std::vector<charts::Distribution> all;
  for (const ToursRun& run : runs) {
    all.push_back({run.method, static_cast<int>(all.size()), {}});
    for (const TourRecord& tour : run.tours)
      for (const TourQuery& q : tour.queries) all.back().values.push_back(q.matched);
  }
  return all;
}

}  // namespace

std::string toHtml(const std::vector<ToursFigure>& figures, const std::vector<ToursRun>& runs,
                   const std::vector<RoomResult>& room, const ToursParams& params,
                   const std::string& settings, std::uint64_t seed) {
  charts::Page page("Tours: two months in a changing building");
  page.paragraph("A robot drives the simulated building (" + params.preset + ", seed " +
                 std::to_string(seed) + ") " + std::to_string(params.tours) + " times. " +
                 std::to_string(params.places) +
                 " places are made from the first tour. Every image of the others is located by itself: the "
                 "place with the most matched points wins, and learns when geometry confirms it.");
  page.table(comparison(figures, params.few_matches));
  page.beginRow();
  page.figure(
      charts::curveChart({"Failures", "tour", "failures [% of images]"}, overTours(runs, failureShare)),
      "Failures of global localisation on each tour");
  page.figure(charts::cumulativeChart({"Matched points", "points matched with the winner", "images [%]"},
                                      matchedPoints(runs),
                                      charts::Threshold{static_cast<double>(params.few_matches),
                                                        std::to_string(params.few_matches) + " points"}),
              "Cumulative distribution of the matched points (compare figure 8 of the paper)");
  page.figure(charts::curveChart(
                  {"Long-term memory", "tour", "features a place"},
                  overTours(runs, [](const ToursRun&, const TourRecord& t) { return t.holdings.longTerm; })),
              "Long-term features a place after each tour (compare figure 5 of the paper)");
  page.figure(charts::curveChart(
                  {"Short-term memory", "tour", "features a place"},
                  overTours(runs, [](const ToursRun&, const TourRecord& t) { return t.holdings.shortTerm; })),
              "Short-term features a place after each tour");
  page.endRow();
  addRoom(page, room);
  return finished(page, settings, seed, false);
}

}  // namespace engram::apps
