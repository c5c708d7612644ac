// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/contender.h"
#include "common/recorded_drive.h"
#include "common/workplace.h"
#include "engram/base/params.h"
#include "engram/features/place_matcher.h"
#include "engram/memory/models.h"
#include "engram/pipeline/pass_gate.h"
#include "engram/pipeline/place_match.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace engram::apps {

/// Section `[tours]`: the protocol of D-10 and D-11.
struct ToursParams {
  std::string preset = "office";     ///< building of the simulator
  int tours = 36;                    ///< the first one makes the map
  int places = 21;                   ///< evenly spaced along the first tour; one image fills each (D-02)
  std::string learn = "after_tour";  ///< when a place learns: `after_tour`, or `at_once` as the paper
  int few_matches = 35;              ///< fewer matched points than this count as few (D-11)

  void describe(base::Params& p);
};

/// The places of a closed tour, by their positions along it.
class TourPlaces {
 public:
  /// @param arcs of the images that made the places [m]. @param length of the tour [m]
  TourPlaces(std::vector<double> arcs, double length) : arcs_(std::move(arcs)), length_(length) {}

  /// Whether the robot at `arc` is between this place and a neighbour of it, or on it: the last place that it
  /// has passed and the next one are right answers.
  bool brackets(int place, double arc) const;
  /// The place nearest along the tour; of two the one with the lower number.
  int nearest(double arc) const;

 private:
  std::vector<double> arcs_;
  double length_;
};

/// What became of one image.
struct TourQuery {
  double arc = 0;  ///< true position along the tour [m]
  int features = 0;
  int winner = -1;      ///< the place with the most matched points; -1 when no place has any
  int matched = 0;      ///< of its long-term features, by descriptors alone
  int verified = 0;     ///< of its long-term features, confirmed by geometry; 0 when that refuses the place
  bool learnt = false;  ///< the winner learns from this image

  bool operator==(const TourQuery&) const = default;
};

/// Places that remember (D-01), and a robot that finds itself in each image anew (D-03).
class TourMemory {
 public:
  /// @param firstViews one image a place (D-02)
  /// @param atOnce a place learns from the image at hand; else from all images of a tour at its end, since
  /// images in a row resemble each other more than any remembered view
  TourMemory(const pipeline::PipelineParams& params, const std::vector<types::Features>& firstViews,
             bool atOnce);

  /// To be called at the end of a tour.
  void finishTour();
  /// Winner takes all on matched points (D-03; of equal ones the lower number). The winner learns when
  /// geometry confirms it as the product asks (D-E4, X-07): whether it is the true place is not looked at.
  TourQuery see(const types::Features& view);

  const std::vector<memory::PlaceMemory>& places() const { return places_; }

 private:
  struct Lesson {
    std::size_t place;
    types::Features view;
  };

  void placeChanged(std::size_t place);
  void learn(std::size_t place, const types::Features& view, const pipeline::PlaceMatch& match);

  bool atOnce_;
  std::vector<Lesson> lessons_;
  pipeline::PipelineParams params_;
  std::unique_ptr<memory::MemoryModel> model_;
  pipeline::PassGate gate_;
  std::vector<memory::PlaceMemory> places_;
  features::PlaceMatcher matcher_;  // of the long-term features
};

/// One tour after another, as one method went through it.
struct TourRecord {
  int tour = 2;       ///< its number; tour 1 made the map
  double day = 0;     ///< since the first tour
  std::string words;  ///< what the building looked like
  std::vector<TourQuery> queries;
  Holdings holdings;  ///< after the tour

  bool operator==(const TourRecord&) const = default;
};

struct ToursRun {
  std::string method;
  double tourLength = 0;          ///< [m]
  std::vector<double> placeArcs;  ///< [m]
  std::vector<TourRecord> tours;

  TourPlaces truth() const { return {placeArcs, tourLength}; }
  bool operator==(const ToursRun&) const = default;
};

class ToursLab {
 public:
  /// @param world seed, change and drive: what happens between and on the tours
  ToursLab(const ToursParams& params, const world::WorldParams& world,
           const pipeline::PipelineParams& pipeline, Workplace place);

  /// Every method on every tour. What the folder holds is read, what it lacks is rendered and measured; a
  /// tour is in memory only while it is looked at. Throws base::Interrupted.
  std::vector<ToursRun> run(const std::vector<Method>& methods);

 private:
  std::vector<std::size_t> chosenImages(const RecordedDrive& first) const;
  std::vector<ToursRun> measure(const std::vector<Method>& methods) const;

  ToursParams params_;
  world::WorldParams world_;
  pipeline::PipelineParams pipeline_;
  Workplace place_;
};

}  // namespace engram::apps
