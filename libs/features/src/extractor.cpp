// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/features/extractor.h"

#include "engram/base/error.h"
#include "opencv_extractors.h"
#include "surf_extractor.h"

namespace engram::features {

void ExtractorParams::describe(base::Params& p) {
  p.addChoice("extractor", extractor, "detector and descriptor", {"surf", "sift", "akaze", "orb"});
  p.add("max_features", max_features, "the strongest features that are kept", {1, 100000});
  p.add("min_features", min_features, "with fewer, a dark image is searched again with a lower threshold",
        {0, 100000});
  p.add("retries", retries, "how often; each time the threshold falls to a quarter", {0, 10});
  p.add("grid_cells", grid_cells,
        "cells per side of a grid that the features are spread over; 0 = strongest anywhere", {0, 64});
  p.add("mask_margin", mask_margin, "share of a feature's radius that must lie inside the mask", {0, 2});
  p.add("upright", upright, "descriptors without orientation: for cameras that stay level");
  p.add("surf_threshold", surf_threshold,
        "SURF: smallest determinant of the Hessian, for grey values in [0, 1]", {1e-9, 1});
  p.add("surf_octaves", surf_octaves, "SURF: octaves of scale", {1, 5});
  p.add("surf_step", surf_step, "SURF: sampling of the first octave in pixels", {1, 2});
  p.add("akaze_threshold", akaze_threshold, "AKAZE: smallest response", {1e-9, 1});
  p.add("sift_contrast", sift_contrast, "SIFT: smallest contrast", {1e-6, 1});
  p.add("sift_root", sift_root, "SIFT: RootSIFT (Arandjelovic & Zisserman 2012)");
  p.add("orb_threshold", orb_threshold, "ORB: FAST threshold in grey levels", {1, 254});
  p.add("orb_levels", orb_levels, "ORB: levels of the image pyramid, a factor 1.2 apart", {1, 16});
}

std::unique_ptr<Extractor> makeExtractor(const ExtractorParams& params) {
  base::validate(params);
  if (params.extractor == "surf") return makeSurfExtractor(params, supportedSimd());
  if (params.extractor == "sift") return makeSiftExtractor(params);
  if (params.extractor == "orb") return makeOrbExtractor(params);
  return makeAkazeExtractor(params);
}

}  // namespace engram::features
