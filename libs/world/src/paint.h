// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/rng.h"

#include <opencv2/core/mat.hpp>

#include <string>

namespace engram::world::paint {

using base::Rng;
using Paint = cv::Scalar;  // BGR, 0 … 255

/// Fractal value noise in about [-1, 1] that tiles: octaves of periods size/cells, halving in size and
/// strength.
cv::Mat1f noise(int width, int height, int cells, int octaves, Rng rng);

/// A whole number of the closed interval [low, high].
inline int pick(Rng& rng, int low, int high) {
  return low + static_cast<int>(rng.below(static_cast<std::uint32_t>(high - low + 1)));
}

Paint randomPaint(Rng& rng, double low, double high);
Paint mix(const Paint& a, const Paint& b, double share);

// Surfaces that tile.
cv::Mat plaster(Rng rng, const Paint& colour);
cv::Mat brick(Rng rng);  ///< 2 x 2 m
cv::Mat wallTiles(Rng rng, const Paint& colour);
cv::Mat panelling(Rng rng);  ///< vertical boards
cv::Mat carpet(Rng rng, const Paint& colour);
cv::Mat parquet(Rng rng);
cv::Mat linoleum(Rng rng, const Paint& colour);
cv::Mat floorTiles(Rng rng);
cv::Mat ceiling(Rng rng);  ///< panels of 0.6 m
cv::Mat wood(Rng rng, const Paint& colour);
cv::Mat fabric(Rng rng, const Paint& colour);
cv::Mat foliage(Rng rng);
cv::Mat grime(Rng rng);  ///< stains, scratches and wear over many metres; grey 128 is clean

// Streets.
cv::Mat facade(Rng rng, const Paint& colour);  ///< tiles; 4 x 4 m, one storey with its windows
cv::Mat street(Rng rng, int kind);             ///< tiles; 4 x 4 m of asphalt, cobbles or slabs
cv::Mat shopFront(Rng rng);                    ///< a window with goods and a name above

// Things with a front.
cv::Mat door(Rng rng, int kind);
cv::Mat doorSign(Rng rng, int number);
cv::Mat poster(Rng rng);
cv::Mat noticeBoard(Rng rng);
cv::Mat bookshelf(Rng rng);
cv::Mat cabinet(Rng rng);
cv::Mat cardboard(Rng rng);
cv::Mat screen(Rng rng);
cv::Mat radiator(Rng rng);
cv::Mat smallThing(Rng rng, int kind);  ///< switches, sockets, thermostats, exit signs, extinguishers, clocks
cv::Mat lamp(Rng rng);
cv::Mat rug(Rng rng);
cv::Mat person(Rng rng);  ///< unrolled, front in the middle, head at the top

/// What the windows show, all round (u) and from 8 m below to 24 m above the floor (v, top down).
/// @param season 0 winter, 1 spring, 2 summer, 3 autumn
cv::Mat outside(Rng rng, int season);

/// Lines that look like writing.
void scribble(cv::Mat& image, const cv::Rect& area, int lineHeight, const Paint& ink, Rng& rng);
void words(cv::Mat& image, cv::Point at, double height, const std::string& text, const Paint& ink,
           int thickness);

}  // namespace engram::world::paint
