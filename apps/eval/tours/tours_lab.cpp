// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tours/tours_lab.h"

#include "engram/base/interrupt.h"
#include "engram/base/parallel.h"
#include "engram/base/progress.h"
#include "engram/pipeline/place_match.h"
#include "tours/tours_run_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <mutex>

namespace engram::apps {
namespace fs = std::filesystem;
namespace {

/// Way from a to b in the direction of travel, in [0, length).
double ahead(double a, double b, double length) {
  const double way = std::fmod(b - a, length);
  return way < 0 ? way + length : way;
}

double dayOf(const RecordedDrive& drive) { return std::floor(drive.samples.front().stamp / 86400.0); }

TourRecord through(const RecordedDrive& drive, double day, TourMemory& memory) {
  TourRecord record{drive.session, day, drive.weather, {}, {}};
  for (const Sample& sample : drive.samples) {
    record.queries.push_back(memory.see(sample.features));
    record.queries.back().arc = sample.arc;
  }
  memory.finishTour();
  std::vector<const memory::PlaceMemory*> places;
  for (const auto& place : memory.places()) places.push_back(&place);
  record.holdings = holdingsOf(places);
  return record;
}

}  // namespace

void ToursParams::describe(base::Params& p) {
  p.addChoice("preset", preset, "building of the simulator", {"tiny", "office", "corridors"});
  p.add("tours", tours, "tours; the first makes the map, the others are located", {2, 1000});
  p.add("places", places, "places, evenly spaced along the first tour", {2, 1000});
  p.addChoice("learn", learn, "when a place learns; the paper: at_once", {"after_tour", "at_once"});
  p.add("few_matches", few_matches, "fewer matched points than this count as few", {1, 10000});
}

bool TourPlaces::brackets(int place, double arc) const {
  std::size_t passed = 0, next = 0;
  for (std::size_t i = 1; i < arcs_.size(); ++i) {
    if (ahead(arcs_[i], arc, length_) < ahead(arcs_[passed], arc, length_)) passed = i;
    if (ahead(arc, arcs_[i], length_) < ahead(arc, arcs_[next], length_)) next = i;
  }
  return place == static_cast<int>(passed) || place == static_cast<int>(next);
}

int TourPlaces::nearest(double arc) const {
  const auto distance = [&](double a) { return std::abs(std::remainder(a - arc, length_)); };
  const auto best = std::min_element(arcs_.begin(), arcs_.end(),
                                     [&](double a, double b) { return distance(a) < distance(b); });
  return static_cast<int>(best - arcs_.begin());
}

TourMemory::TourMemory(const pipeline::PipelineParams& params, const std::vector<types::Features>& firstViews,
                       bool atOnce)
    : atOnce_(atOnce),
      params_(params),
      model_(memory::makeMemoryModel(params.memory, params.fsh, params.multi_store)),
      gate_(params.memory) {
  for (const types::Features& view : firstViews) {
    places_.push_back(model_->start(view));
    placeChanged(places_.size() - 1);
  }
}

void TourMemory::placeChanged(std::size_t place) {
  matcher_.set(place, places_[place].features.subset(places_[place].longTerm()));
}

TourQuery TourMemory::see(const types::Features& view) {
  TourQuery query;
  query.features = static_cast<int>(view.size());
  const std::vector<int> counts = matcher_.ratioMatchCounts(view, params_.match);
  const auto best = std::max_element(counts.begin(), counts.end());
  if (best == counts.end() || *best == 0) return query;
  query.matched = *best;
  query.winner = static_cast<int>(best - counts.begin());

  const auto at = static_cast<std::size_t>(query.winner);
  const pipeline::PlaceMatch match = pipeline::matchToPlace(view, places_[at], params_.match, params_.verify);
  if (match.verified()) query.verified = match.longTermInliers;
  if (!pipeline::strongEnough(match, params_.recognise)) return query;
  gate_.accepted(base::PlaceId(static_cast<std::uint32_t>(at)));
  if (!gate_.open()) return query;
  gate_.learnt();
  query.learnt = true;
  if (atOnce_)
    learn(at, view, match);
  else
    lessons_.push_back({at, view});
  return query;
}

void TourMemory::learn(std::size_t place, const types::Features& view, const pipeline::PlaceMatch& match) {
  model_->update(places_[place], pipeline::inPlaceFrame(view, match.R_place_view), match.matches);
  placeChanged(place);
}

/// Each view is matched again: its place may have learnt from one before it.
void TourMemory::finishTour() {
  for (const Lesson& lesson : lessons_) {
    const auto match =
        pipeline::matchToPlace(lesson.view, places_[lesson.place], params_.match, params_.verify);
    if (pipeline::strongEnough(match, params_.recognise)) learn(lesson.place, lesson.view, match);
  }
  lessons_.clear();
  gate_.restart();
}

ToursLab::ToursLab(const ToursParams& params, const world::WorldParams& world,
                   const pipeline::PipelineParams& pipeline, Workplace place)
    : params_(params), world_(world), pipeline_(pipeline), place_(std::move(place)) {
  base::validate(params_);
}

std::vector<ToursRun> ToursLab::run(const std::vector<Method>& methods) {
  const fs::path folder = place_.subfolder("runs");
  const auto fileOf = [&](const std::string& method) { return (folder / (method + ".json")).string(); };
  std::vector<Method> missing;
  for (const Method& method : methods)
    if (!fs::exists(fileOf(method.name))) missing.push_back(method);
  if (!missing.empty())
    for (const ToursRun& run : measure(missing)) writeToursRun(fileOf(run.method), run);
  std::vector<ToursRun> runs;  // from the files also when just measured: both ways give the same digits
  for (const Method& method : methods) runs.push_back(readToursRun(fileOf(method.name)));
  return runs;
}

/// The images of the first tour that make the places. All of it is recorded, so that another number of places
/// needs no new drives.
std::vector<std::size_t> ToursLab::chosenImages(const RecordedDrive& first) const {
  std::vector<double> arcs;
  for (const Sample& sample : first.samples) arcs.push_back(sample.arc);
  return nearestToStations(params_.places, first.tourLength).choose(arcs);
}

/// Tour by tour, so that one drive is in memory at a time; the methods side by side.
std::vector<ToursRun> ToursLab::measure(const std::vector<Method>& methods) const {
  const world::World world = world::World::preset(params_.preset, world_);
  const std::string folder = place_.subfolder("drives");
  DriveRecorder recorder(world, world::presetEyes("omni"), pipeline_.extractor,
                         {folder, 0.0, place_.threads});
  const double length = world.route().length();
  const double images = length / world_.drive.spacing;
  base::Progress progress(place_.progress, "tours");
  std::size_t done = 0;
  const auto tick = [&](int tour, std::size_t of) {
    progress.update(std::min(1.0, (tour - 1 + static_cast<double>(of) / images) / params_.tours), done + of);
  };

  const RecordedDrive first =
      recorder.record(1, world::DriveKind::kTour, allImages(), [&](std::size_t of) { tick(1, of); });
  done += first.samples.size();
  std::vector<types::Features> firstViews;
  std::vector<ToursRun> runs(methods.size());
  std::vector<double> arcs;
  for (const std::size_t i : chosenImages(first)) {
    firstViews.push_back(first.samples[i].features);
    arcs.push_back(first.samples[i].arc);
  }
  std::vector<std::unique_ptr<TourMemory>> memories;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    memories.push_back(
        std::make_unique<TourMemory>(methods[m].params, firstViews, params_.learn == "at_once"));
    runs[m] = {methods[m].name, length, arcs, {}};
  }
  for (int tour = 2; tour <= params_.tours; ++tour) {
    const RecordedDrive drive =
        recorder.record(tour, world::DriveKind::kTour, allImages(), [&](std::size_t of) { tick(tour, of); });
    base::parallelFor(methods.size(), place_.threads, [&](std::size_t m) {
      runs[m].tours.push_back(through(drive, dayOf(drive) - dayOf(first), *memories[m]));
    });
    if (base::interrupted()) throw base::Interrupted("going through the tours");
    done += drive.samples.size();
    tick(tour + 1, 0);
  }
  return runs;
}

}  // namespace engram::apps
