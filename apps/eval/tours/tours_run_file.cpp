// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tours/tours_run_file.h"

#include "engram/apps/json_file.h"
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"

namespace engram::apps {
namespace {

using nlohmann::json;

json toJson(const TourRecord& tour) {
  const Holdings& h = tour.holdings;
  json queries = json::array();
  for (const TourQuery& q : tour.queries)
    queries.push_back({q.arc, q.features, q.winner, q.matched, q.verified, q.learnt});
  return {{"tour", tour.tour},
          {"day", tour.day},
          {"words", tour.words},
          {"long_term", h.longTerm},
          {"long_term_sigma", h.longTermSigma},
          {"short_term", h.shortTerm},
          {"short_term_sigma", h.shortTermSigma},
          {"bytes_per_place", h.bytesPerPlace},
          {"queries", queries}};  // arc, features, winner, matched, verified, learnt
}

TourRecord tourFrom(const json& j) {
  TourRecord tour;
  tour.tour = j.at("tour").get<int>();
  tour.day = j.at("day").get<double>();
  tour.words = j.at("words").get<std::string>();
  tour.holdings = {j.at("long_term").get<double>(), j.at("short_term").get<double>(),
                   j.at("long_term_sigma").get<double>(), j.at("short_term_sigma").get<double>(),
                   j.at("bytes_per_place").get<double>()};
  for (const json& q : j.at("queries"))
    tour.queries.push_back({q.at(0).get<double>(), q.at(1).get<int>(), q.at(2).get<int>(), q.at(3).get<int>(),
                            q.at(4).get<int>(), q.at(5).get<bool>()});
  return tour;
}

}  // namespace

void writeToursRun(const std::string& path, const ToursRun& run) {
  json tours = json::array();
  for (const TourRecord& tour : run.tours) tours.push_back(toJson(tour));
  const json file{{"method", run.method},
                  {"tour_length", run.tourLength},
                  {"place_arcs", run.placeArcs},
                  {"tours", tours}};
  base::writeText(path, toText(file), true);
}

ToursRun readToursRun(const std::string& path) {
  try {
    const json file = readJson(path);
    ToursRun run;
    run.method = file.at("method").get<std::string>();
    run.tourLength = file.at("tour_length").get<double>();
    run.placeArcs = file.at("place_arcs").get<std::vector<double>>();
    for (const json& tour : file.at("tours")) run.tours.push_back(tourFrom(tour));
    return run;
  } catch (const json::exception& e) {
    throw base::Error(path + ": cannot be read (" + e.what() + "); remove it and it is measured again");
  }
}

}  // namespace engram::apps
