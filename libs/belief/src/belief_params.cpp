// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/belief/belief_params.h"

namespace engram::belief {

void BeliefParams::describe(base::Params& p) {
  p.addChoice("filter", filter,
              "what images in a row make of each other: a discrete Bayes filter; or nothing, the most likely "
              "place of each image takes all belief",
              {"bayes", "winner_takes_all"});
  p.add("sigma_hops", sigma_hops, "Gaussian of the motion model on graph distance [hops]", {0.05, 100});
  p.add("expected_hops", expected_hops,
        "its centre; 1 gives the neighbours more than the place itself [hops]", {0, 10});
  p.add("sigma_odometry", sigma_odometry, "the same where the distance travelled is known [hops]",
        {0.05, 100});
  p.add("hop_radius", hop_radius, "the motion model ends there [hops]", {1, 100});
  p.add("teleport", teleport, "share of the belief spread over all places at each image", {0, 1});
  p.add("new_place_prior", new_place_prior, "probability that the next image shows a place not in the map",
        {0, 1});
  p.add("new_place_persistence", new_place_persistence, "the same after an image that did", {0, 1});
  p.add("new_place_similarity", new_place_similarity, "similarity that an unknown place would show", {0, 1});
  p.addChoice("likelihood", likelihood,
              "sensor model: F eq (9) read as a Gaussian of 1 - s or as exp(+s), A-E11, or how far a place "
              "stands out of the similarities that the image has with all places",
              {"gaussian", "exponential", "angeli", "standardised"});
  p.add("sigma_z", sigma_z, "spread of the similarity in F eq (9), (10); 0 takes it from the map", {0, 10});
  p.add("sigma_z_min", sigma_z_min, "lower bound of the spread taken from the map", {1e-4, 10});
  p.add("sum_of_gaussians", sum_of_gaussians, "F eq (10), (11): Gaussians on the peaks of the similarity");
  p.add("peak_sigma", peak_sigma, "sigma_l of F eq (11) [hops]", {0.05, 100});
  p.add("floor", floor, "smallest likelihood, relative to the largest", {1e-12, 1});
  p.add("evidence", evidence,
        "likelihood = standardised: weight of one standard deviation of the background [nat]", {0.01, 10});
  p.add("background", background,
        "likelihood = standardised: share of the evidence that is spread over all places, however many",
        {1e-6, 0.5});
  p.add("accept_threshold", accept_threshold, "smallest belief in a neighbourhood that is accepted", {0, 1});
  p.add("accept_hops", accept_hops, "radius of that neighbourhood [hops]", {0, 100});
  p.addChoice("advance", advance,
              "motion from image to image: not known, learnt along the chain of places, or in the direction "
              "and over the distance that odometry reports",
              {"none", "learned", "odometry"});
  p.add("advance_max", advance_max, "largest step that is learnt, either way [places/image]", {1, 20});
  p.add("advance_resolution", advance_resolution, "steps that are told apart, for each place", {1, 10});
  p.add("advance_persistence", advance_persistence, "probability that a step is like the one before", {0, 1});
  p.add("advance_blind", advance_blind, "share that moves by the Gaussian on hops all the same", {0.001, 1});
  p.add("advance_forgetting", advance_forgetting, "weight of the past in the learnt steps, per image",
        {0, 0.9999});
  p.add("advance_headings", advance_headings,
        "advance = odometry: rotations between odometry and map that are told apart", {4, 360});
  p.addDegrees(
      "view_sigma_deg", view_sigma,
      "advance = odometry: heading within which a place is recognised [deg]; 0: at any, as for a camera "
      "that sees all round",
      {0, 180});
}

}  // namespace engram::belief
