// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/appearance/describer.h"
#include "engram/base/config.h"
#include "engram/belief/bayes_filter.h"
#include "engram/features/extractor.h"
#include "engram/features/matching.h"
#include "engram/geometry/stereo_verify.h"
#include "engram/geometry/verify.h"
#include "engram/memory/models.h"
#include "engram/odometry/params.h"
#include "engram/odometry/visual_scan.h"
#include "engram/pipeline/perception.h"
#include "engram/posegraph/relaxer.h"
#include "engram/upkeep/upkeep.h"
#include "engram/vocabulary/vocabulary_tree.h"
#include "engram/vocabulary/word_dictionary.h"

#include <string>

namespace engram::pipeline {

/// Section `[select]`: which images are looked at.
struct SelectParams {
  double min_distance = 0.4;  ///< [m] since the last keyframe, with odometry
  double min_rotation =
      0.5235987756;  ///< [rad] since the last keyframe, with odometry; either one is enough (A-E12)
  double standing_similarity =
      0.95;  ///< without odometry: an image this similar to the last keyframe is dropped (F-07)

  void describe(base::Params& p);
};

/// Section `[place]`: when an image is a new place.
struct PlaceParams {
  double spacing = 0.8;  ///< [m] from all places at which an image makes a new one, with odometry
  double same_similarity =
      0.9;              ///< without odometry: an image this similar to a place just made is that place (F-07)
  int recent_hops = 6;  ///< places this near in the graph to the newest one are no loop closure
  int patience = 5;     ///< unrecognised images in a row in known territory before new places are made
  int keep_thumbnails = 128;  ///< width of the stored thumbnail of a place [px]; 0 stores none

  void describe(base::Params& p);
};

/// Section `[recognise]`.
struct RecogniseParams {
  std::string scorer = "ltm_match";  ///< what scores the places: see makeScorer()
  int exhaustive_places = 200;  ///< ltm_match: in a map of more an index proposes those that are matched,
  int proposals = 60;           ///< so many
  int rescore = 30;             ///< tfidf_incremental: places that are matched by descriptors; 0: words alone
  int verified_scores =
      0;               ///< best places whose score counts verified matches alone; 0: scores by descriptors
  int candidates = 5;  ///< hypotheses that go to geometric verification, best first
  int reported = 5;    ///< hypotheses that are in the record of an image, best first
  int accept_inliers = 20;       ///< verified matches that acceptance needs
  double accept_log10_nfa = -5;  ///< or matches that are so unlikely to be an accident
  double ambiguity =
      0.8;           ///< a leap is refused when a far place has so many of its verified matches; 0: never
  int sequence = 0;  ///< images that together may place the robot where geometry is thin; 0: never
  int closure_inliers = 30;  ///< the same for a loop closure: K-15 saw no false one from 30 on
  /// So many verified matches need no belief (K-15, K-21); 0: belief always decides. 24: Gardens Point image
  /// by image; shown on Milford and in the simulated office.
  int sure_inliers = 24;
  double closure_similarity =
      0.35;  ///< new_place_similarity while mapping: what unlike places of a building share
  double accept_similarity = 0.2;  ///< F eq (8) with verified matches that acceptance needs
  int learn_after = 3;  ///< accepted images in a row that agree with odometry before a place learns (F-E16)
  int learn_hops = 6;   ///< a place learns when the robot is more than so many edges away from it
  int threads = 1;      ///< the result does not depend on it

  void describe(base::Params& p);
};

/// Section `[odometry]`: the noise of wheel odometry (A-08 with A-E7, A-E8).
struct OdometryParams {
  double sigma_per_metre = 0.03;           ///< [m/m], along and across
  double sigma_heading_per_metre = 0.01;   ///< [rad/m]
  double sigma_heading_per_radian = 0.03;  ///< [rad/rad]
  double sigma_floor = 0.01;               ///< [m] and [rad]: no edge is stiffer
  double sigma_scale = 0.01;               ///< [m/m] of the wheel radius, over drives
  double max_drift = 0.1;  ///< [m/m] localising: of the way between two accepted places; more is a leap
  // What the robot can do. Odometry that says more leaps: its counter was reset, or a reading is wild.
  double max_speed = 40;                    ///< [m/s]
  double max_acceleration = 2.5;            ///< [m/s^2]
  double max_turn_rate = 4.71238898038469;  ///< [rad/s]

  void describe(base::Params& p);
};

/// Section `[mapping]`.
struct MappingParams {
  std::string nodes = "places";  ///< what the nodes of the map are: see recipeOf()

  void describe(base::Params& p);
};

/// Section `[views]`: maps of stereo views (Konolige & Bowman 2009).
struct ViewParams {
  double min_interval = 0.5;  ///< [s] between two views of the map (K-20: 15 frames at 30 Hz)
  int max_features = 300;     ///< of a view, the strongest whose range is known (K-38)
  int candidates = 15;        ///< views that go to geometric verification (K-15)
  /// Inliers of a link that tells what nothing else tells, as K's experiments have it; others must agree with
  /// the graph and need only those of [stereo] (K-E5, K-18).
  int sure_inliers = 80;
  double agree_distance = 0.5;  ///< [m] that a link may differ from the graph,
  double agree_angle = 0.35;    ///< [rad] that it may,
  double max_drift = 0.05;      ///< [m/m] and more on the way since the last link that closed a loop
  double max_speed = 3;         ///< [m/s] of the robot: visual odometry that is faster has failed
  std::string vocabulary;       ///< file of a vocabulary tree; empty: trained on the map's own views
  int train_after = 60;         ///< views from which such a tree is trained; all views are matched till then
  double retrain_growth = 4;    ///< it is trained anew when the map has so many times as many views
  bool wheels = true;           ///< wheel odometry, where there is any, bridges what visual odometry cannot
  double sigma_floor = 0.002;   ///< [m] and [rad]: no link is stiffer
  double weak_sigma = 10;       ///< [m] of a weak link; 1 rad counts as 1 m (K-11)
  double relax_sigma = 2;       ///< disagreement of a new link with the poses from which they are relaxed
  double relax_all_sigma = 3;   ///< the same after its surroundings were relaxed, for the whole map

  void describe(base::Params& p);
};

/// Section `[scans]`: visual scans (Bertolli, Jensfelt & Christensen 2006).
struct ScansParams {
  odometry::ScanParams scan;
  odometry::ScanMatchParams match;
  bool refine = true;  ///< disparities by correlation where that finds them, not by keypoints alone
  double reach = 3;    ///< [m] from a reference at which the robot can match it (V-E5)
  int candidates = 6;  ///< references near the robot that are matched, nearest first
  /// A reference matched by fewer points does not keep the scan before from becoming one; 0: V-08 as written.
  int thin = 40;
  double step = 0.3;           ///< [m] without wheels: deviation of the motion from the one before, an image
  double turn = 0.1745329252;  ///< [rad] the same

  void describe(base::Params& p);
};

/// The whole configuration of a pipeline.
struct PipelineParams {
  MappingParams mapping;
  CameraParams camera;
  features::ExtractorParams extractor;
  features::MatchParams match;
  vocabulary::WordParams words;
  vocabulary::TreeParams tree;
  geometry::VerifyParams verify;
  geometry::StereoVerifyParams stereo;
  odometry::OdometryParams visual_odometry;
  SelectParams select;
  RecogniseParams recognise;
  belief::BeliefParams belief;
  appearance::AppearanceParams appearance;
  PlaceParams place;
  OdometryParams odometry;
  memory::MemoryParams memory;
  memory::FshParams fsh;
  memory::MultiStoreParams multi_store;
  posegraph::RelaxerParams posegraph;
  ViewParams views;
  ScansParams scans;
  upkeep::UpkeepParams upkeep;

  /// Binds every struct to its section; this object must outlive `config`.
  void bind(base::Config& config);
};

}  // namespace engram::pipeline
