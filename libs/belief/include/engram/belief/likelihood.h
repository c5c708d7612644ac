// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/belief/adjacency.h"
#include "engram/belief/belief_params.h"

#include <optional>
#include <span>
#include <vector>

namespace engram::belief {

/// p(z | place) up to a common factor; the largest is 1.
struct Likelihood {
  std::vector<double> places;
  double newPlace = 0.0;  ///< of the new-place state; without meaning where there is none
  double floor = 0.0;     ///< none is below it: what an image says that says nothing
};

/// The sensor model from similarities in [0, 1], one a place.
///
/// F eq (9) falls with the similarity as printed; read as a Gaussian of 1 - s (default) or exp(+s /
/// sigma_z^2): see F-E1. With `sum_of_gaussians` it is F eq (10), (11): Gaussians in node space on the peaks
/// of s within sigma_z of the maximum, weighted by the peak: see F-E12. The new place counts as one more
/// place, far from all others, with the similarity `new_place_similarity`. `angeli` is A-E11, which has its
/// own rule for it. `standardised` is ours: see below. Throws std::invalid_argument when a similarity is
/// outside [0, 1] or their number is not that of the places.
/// @param newPlace for `standardised`: the similarity with which the new place counts as one more place;
/// none: it shows the background, and the image says nothing of it
Likelihood likelihood(std::span<const double> similarities, const Adjacency& adjacency,
                      const BeliefParams& params, std::optional<double> newPlace = {});

/// How far each similarity stands out of those that the image has with all places: its distance from their
/// median in units of their spread, 1.4826 times the median absolute deviation, but at least sigma_z_min.
/// `new_place_similarity` counts like a few places more, which matters in a map of few. A place that the
/// image does not show is a sample of that background; one that it shows is exp(evidence * z) times as
/// likely. So an image at night, all of whose similarities are small, tells as much as one by day.
std::vector<double> standardised(std::span<const double> similarities, const BeliefParams& params);

/// sigma_z of F eq (9), (10): as given, or the standard deviation of the similarity over the map.
double similaritySpread(std::span<const double> similarities, const BeliefParams& params);

}  // namespace engram::belief
