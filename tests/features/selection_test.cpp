// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "selection.h"

#include "engram/base/rng.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

namespace engram::features {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

types::Keypoint at(float x, float y, float response, float size = 10) { return {x, y, size, 0, response, 0}; }

TEST(StrongestFirst, BreaksTiesByPosition) {
  const std::vector<types::Keypoint> k{at(5, 5, 1), at(4, 5, 1), at(9, 4, 1), at(0, 0, 0), at(0, 0, 2)};
  EXPECT_THAT(strongestFirst(k), ElementsAre(4, 2, 1, 0, 3));
}

TEST(InsideMask, MeasuresTheRadius) {
  cv::Mat mask(100, 100, CV_8U, cv::Scalar(255));
  mask.colRange(0, 50).setTo(0);
  const std::vector<types::Keypoint> k{at(49, 50, 1, 0), at(50, 50, 1, 0), at(59, 50, 1, 20),
                                       at(61, 50, 1, 20)};
  EXPECT_THAT(insideMask(k, mask, 1.0), ElementsAre(1, 3));
  EXPECT_THAT(insideMask(k, mask, 0.5), ElementsAre(1, 2, 3));
  EXPECT_THAT(insideMask(k, cv::Mat(), 1.0), ElementsAre(0, 1, 2, 3));
}

TEST(InsideMask, IgnoresTheImageBorder) {
  const cv::Mat mask(100, 100, CV_8U, cv::Scalar(255));
  const std::vector<types::Keypoint> k{at(2, 2, 1, 40), at(99, 99, 1, 40)};
  EXPECT_THAT(insideMask(k, mask, 1.0), ElementsAre(0, 1));
}

TEST(Strongest, EveryCellGetsItsShareAndTheRestIsFilled) {
  base::Rng rng(3);
  std::vector<types::Keypoint> k;
  for (int i = 0; i < 300; ++i)  // one corner holds nearly all, and all of the strongest
    k.push_back(at(float(rng.uniform(0, 25)), float(rng.uniform(0, 25)), float(rng.uniform(10, 20))));
  for (int i = 0; i < 12; ++i) k.push_back(at(float(25 * (i % 4) + 12), float(25 * (i / 4 + 1) + 12), 1.0f));
  std::vector<int> all(k.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = int(i);

  const auto kept = strongest(k, all, {100, 100}, 64, 4);
  ASSERT_EQ(kept.size(), 64u);
  EXPECT_EQ(std::set<int>(kept.begin(), kept.end()).size(), 64u);
  const auto weak = std::count_if(kept.begin(), kept.end(), [](int i) { return i >= 300; });
  EXPECT_EQ(weak, 12);  // the share is 4 a cell and no cell has more than that
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end(), [&](int a, int b) {
    return k[std::size_t(a)].response > k[std::size_t(b)].response;
  }));
  EXPECT_THAT(strongest(k, {}, {100, 100}, 64, 4), IsEmpty());
}

}  // namespace
}  // namespace engram::features
