// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/workplace.h"
#include "engram/pipeline/params.h"
#include "engram/world/world.h"
#include "views/views_mapping.h"

#include <memory>
#include <string>
#include <vector>

namespace engram::apps {

/// Section `[views_world]`: the experiments of Konolige & Bowman on the simulator.
struct ViewsWorldParams {
  std::string building = "office";  ///< preset of the sequences and of the repair
  int sequences = 6;                ///< K-35
  int orders = 5;                   ///< random orders of the sequences
  bool wheels = true;               ///< drives have wheel odometry; that of the repair never has
  int covers = 20;                  ///< times that both eyes are covered in the repair drive (K-36)
  double cover_length = 1.5;        ///< way that a cover lasts [m]
  std::string lifelong_building = "tiny";
  int sessions = 50;                ///< of the lifelong run
  std::string sudden = "15,30,45";  ///< sessions of it before which much changes at once
  int lifelong_views = 5;           ///< kappa of the lifelong run
  std::string kappas = "2,3,5,7,10,15,20";
  int kappa_sessions = 12;            ///< sessions of the table over kappa
  int poses = 12;                     ///< reference poses of the recognition rate (K-17)
  double false_distance = 0.5;        ///< a link this far from the truth is false [m]
  double false_angle = 0.1745329252;  ///< or this far [rad]
  double right_within = 1.0;          ///< an image is located right when the place is this near [m]
  double locate_every = 0.5;          ///< way between images that are located [m]
  double sequence_scale = 1;          ///< size of the images of the sequences, of those of the camera
  double lifelong_scale = 0.6;        ///< the same of the lifelong run

  void describe(base::Params& p);
};

/// One map of all sequences, in some order (K-35).
struct OrderedRun {
  std::vector<int> order;  ///< of the sequences, from 0
  std::vector<ViewSession> sessions;
  double ate = 0, length = 0;  ///< [m]
  double apart = 0;            ///< share of the way that is in other parts of the map
};

/// K-36.
struct RepairRun {
  ViewSession session;
  std::vector<std::pair<std::size_t, std::size_t>> covers;
  int linksWithin = 0;         ///< links of its views to views of the same drive
  int linksAcross = 0;         ///< to older ones
  LocatedShare before, after;  ///< a drive of a later day, in the map without and with the repair
};

/// Sessions in one building with one rule of forgetting.
struct LifelongRun {
  std::string rule;  ///< `none`, or kappa
  std::vector<ViewSession> sessions;
  std::vector<LocatedShare> located;  ///< images of each session in the map before it; the first is empty
  double ate = 0;                     ///< [m]
};

/// Images beside reference poses (K-17).
struct OffsetCell {
  double distance = 0;  ///< [m]
  double angle = 0;     ///< [rad]
  int tried = 0, recognised = 0;
};

/// Environment classes of Fig. 4 (K-32): one spot, looked at again and again.
struct SpotRun {
  std::string name, about;
  int looks = 0;
  std::vector<int> views;  ///< kept after each look
  int matched = 0;         ///< looks that matched a view that was kept
};

struct ViewsResult {
  std::vector<OrderedRun> orders;  ///< the first in the order of the drives
  double tour = 0;                 ///< length of one round of the building [m]
  RepairRun repair;
  std::vector<LifelongRun> lifelong;  ///< without deletion, with it
  std::vector<LifelongRun> kappas;
  std::vector<OffsetCell> offsets;
  std::vector<SpotRun> spots;
};

/// Runs the experiments; drives are rendered once and kept in the folder.
class ViewsWorld {
 public:
  ViewsWorld(const ViewsWorldParams& params, const world::WorldParams& world,
             const pipeline::PipelineParams& pipeline, Workplace place);

  /// Throws base::Interrupted on Ctrl-C: the drives that were rendered are kept.
  ViewsResult run();

 private:
  /// A camera, with the configuration that uses it.
  struct Eye {
    world::Eyes eyes;
    pipeline::PipelineParams pipeline;
  };
  Eye makeEye(double scale, const std::string& name) const;
  std::vector<KeptDrive> keep(const world::World& world, const Eye& eye, int sessions,
                              const std::string& name) const;

  OrderedRun mapInOrder(const std::vector<int>& order, const std::string& name) const;
  RepairRun repair() const;
  /// @param name of the map file
  LifelongRun live(const std::string& name, const std::string& rule, int sessions,
                   const std::string& vocabulary) const;
  std::string trainVocabulary() const;
  std::vector<OffsetCell> offsets() const;
  std::vector<SpotRun> spots() const;

  ViewsWorldParams params_;
  world::WorldParams world_;
  pipeline::PipelineParams pipeline_;
  Workplace place_;
  std::unique_ptr<world::World> building_, lifelongBuilding_;
  Eye eye_, lifelongEye_;
  std::vector<KeptDrive> drives_, lifelongDrives_;
};

/// Parts of the tour that the sequences show: they start anywhere and overlap.
ShownDrive sequenceOf(const KeptDrive& drive, int number, bool wheels);
/// Places of the covers, spread over the drive by the seed.
std::vector<std::pair<std::size_t, std::size_t>> coversOf(const KeptDrive& drive, int covers, double length,
                                                          std::uint64_t seed);

}  // namespace engram::apps
