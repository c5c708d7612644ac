// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cpu.h"
#include "integral_image.h"

#include <cstdint>
#include <vector>

namespace engram::features {

/// A box filter of three lobes: the second derivative of a Gaussian of sigma 1.2 / 9 * size() (Bay 2008,
/// figure 3).
struct BoxFilter {
  int lobe = 3;  ///< odd
  int size() const { return 3 * lobe; }
  int half() const { return size() / 2; }  ///< pixels needed on each side of the centre
};

/// Responses of one image row, all columns at once. The filter must fit vertically.
class HessianRows {
 public:
  explicit HessianRows(SimdLevel level, const IntegralImage& image);

  /// Normalised determinants Dxx Dyy - (0.9 Dxy)² of row y at columns x = 0, step, 2 step, … into out[x /
  /// step]; columns where the filter does not fit are left alone.
  void compute(BoxFilter filter, int y, int step, float* out);

 private:
  const SimdLevel level_;
  const IntegralImage& image_;
  std::vector<std::int32_t> xBand_, yBand_, xyBand_;  // sums over the rows of each filter, per column
  std::vector<float> dense_;
};

/// Sign of the Laplacian Dxx + Dyy at one pixel: -1 for a bright blob, +1 for a dark one (and for 0).
int laplacianSign(const IntegralImage& image, BoxFilter filter, int y, int x);

/// Maxima among their 26 neighbours, larger than a threshold. Of equal neighbours the first in the order
/// layer, row, column wins.
struct Neighbourhood {
  const float* rows[3][3];  ///< [layer][row]
};
/// Appends the columns of [begin, end) that are maxima; begin >= 1, and column `end` is readable.
void findMaxima(SimdLevel level, const Neighbourhood& n, int begin, int end, float threshold,
                std::vector<int>& columns);

}  // namespace engram::features
