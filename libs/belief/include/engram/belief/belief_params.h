// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"

#include <string>

namespace engram::belief {

/// Section `[belief]`.
struct BeliefParams {
  /// `bayes`, or `winner_takes_all`: each image by itself, the place with the largest likelihood (D-03).
  std::string filter = "bayes";

  // Motion, F eq (7) with the reading of F-E2.
  double sigma_hops = 2.0;      ///< [hops] of the Gaussian on graph distance
  double expected_hops = 0.0;   ///< centre of that Gaussian; 1 puts more mass on the neighbours, as A-16
  double sigma_odometry = 0.7;  ///< [hops] the same when the distance travelled is known
  int hop_radius = 6;           ///< cut of the Gaussian
  double teleport = 0.01;       ///< share of the belief spread over all places: recovery from a wrong belief

  // The new-place state of SLAM mode.
  double new_place_prior = 0.1;        ///< probability that a step leads to a place not in the map
  double new_place_persistence = 0.9;  ///< probability that the step after it does so again
  double new_place_similarity = 0.1;   ///< similarity that an unknown place would show

  // Sensor: how far a place stands out of all; F eq (9) to (11) with the readings of F-E1 and F-E12; A-E11.
  std::string likelihood = "standardised";
  double sigma_z = 0.0;          ///< similarity; 0 takes the standard deviation over the map, as the paper
  double sigma_z_min = 0.02;     ///< lower bound of that
  bool sum_of_gaussians = true;  ///< F eq (10), (11)
  double peak_sigma = 1.0;       ///< [hops] sigma_l of F eq (11)
  double floor = 0.02;           ///< smallest likelihood relative to the largest
  double evidence = 0.5;         ///< standardised: [nat] a standard deviation of the image's own scores
  double background = 0.02;      ///< standardised: share of the evidence for the places that is no evidence

  // Acceptance, A-18.
  double accept_threshold = 0.8;  ///< on the sum over the neighbourhood (A-19)
  int accept_hops = 4;            ///< size of that neighbourhood (A-E10: not given)

  // Advance from image to image: along the chain of places, learnt from the belief itself; or as odometry
  // reports it.
  std::string advance = "learned";
  int advance_max = 3;  ///< [places/image] largest step that is learnt, either way
  int advance_resolution =
      4;  ///< steps that are told apart, for each place: a camera may take four images a place
  double advance_persistence = 0.9;  ///< probability that a step is like the one before
  double advance_blind = 0.1;        ///< share that moves by the Gaussian on hops all the same
  double advance_forgetting = 0.9;   ///< weight of the past in the learnt distribution, per image
  int advance_headings = 16;         ///< rotations between odometry and map that are told apart
  double view_sigma =
      0.0;  ///< [rad] heading within which a place is recognised; 0: the camera sees all round

  void describe(base::Params& p);
};

}  // namespace engram::belief
