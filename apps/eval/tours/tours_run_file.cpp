// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tours/tours_run_file.h"

#include "common/kept_file.h"

namespace engram::apps {
namespace {

using nlohmann::json;

json toJson(const TourRecord& tour) {
  json queries = json::array();
  for (const TourQuery& q : tour.queries)
    queries.push_back({q.arc, q.features, q.winner, q.matched, q.verified, q.learnt});
  json j = toJson(tour.holdings);
  // A query: arc, features, winner, matched, verified, learnt.
  j.update({{"tour", tour.tour}, {"day", tour.day}, {"words", tour.words}, {"queries", queries}});
  return j;
}

TourRecord tourFrom(const json& j) {
  TourRecord tour;
  tour.tour = j.at("tour").get<int>();
  tour.day = j.at("day").get<double>();
  tour.words = j.at("words").get<std::string>();
  tour.holdings = holdingsFrom(j);
  for (const json& q : j.at("queries"))
    tour.queries.push_back({q.at(0).get<double>(), q.at(1).get<int>(), q.at(2).get<int>(), q.at(3).get<int>(),
                            q.at(4).get<int>(), q.at(5).get<bool>()});
  return tour;
}

}  // namespace

void writeToursRun(const std::string& path, const ToursRun& run) {
  json tours = json::array();
  for (const TourRecord& tour : run.tours) tours.push_back(toJson(tour));
  writeKept(path, {{"method", run.method},
                   {"tour_length", run.tourLength},
                   {"place_arcs", run.placeArcs},
                   {"tours", tours}});
}

ToursRun readToursRun(const std::string& path) {
  return readKept(path, [](const json& file) {
    ToursRun run;
    run.method = file.at("method").get<std::string>();
    run.tourLength = file.at("tour_length").get<double>();
    run.placeArcs = file.at("place_arcs").get<std::vector<double>>();
    for (const json& tour : file.at("tours")) run.tours.push_back(tourFrom(tour));
    return run;
  });
}

}  // namespace engram::apps
