// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/features/extractor.h"

#include "engram/base/error.h"
#include "engram/base/parallel.h"
#include "scene.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <numbers>

namespace engram::features {
namespace {

class EveryExtractor : public testing::TestWithParam<const char*> {
 protected:
  ExtractorParams params() const {
    ExtractorParams p;
    p.extractor = GetParam();
    return p;
  }
  types::Features extract(const ExtractorParams& p, const cv::Mat& image, const cv::Mat& mask = {}) const {
    return makeExtractor(p)->extract(image, mask);
  }
  const cv::Mat scene_ = test::texturedScene(320, 240, 1);
};

bool same(const types::Features& a, const types::Features& b) {
  if (a.size() != b.size() || !(a.descriptors == b.descriptors)) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto &p = a.keypoints[i], &q = b.keypoints[i];
    if (p.x != q.x || p.y != q.y || p.size != q.size || p.angle != q.angle || p.response != q.response)
      return false;
  }
  return true;
}

TEST_P(EveryExtractor, FillsParallelArraysStrongestFirst) {
  const auto extractor = makeExtractor(params());
  const auto f = extractor->extract(scene_, {});
  ASSERT_GT(f.size(), 100u);
  EXPECT_LE(f.size(), 600u);
  EXPECT_EQ(f.descriptors.size(), f.size());
  EXPECT_EQ(f.descriptors.kind(), extractor->kind());
  EXPECT_EQ(f.descriptors.dim(), extractor->dim());
  EXPECT_EQ(extractor->name(), GetParam());
  for (std::size_t i = 0; i < f.size(); ++i) {
    const auto& k = f.keypoints[i];
    EXPECT_TRUE(k.x >= 0 && k.y >= 0 && k.x <= 319 && k.y <= 239);
    EXPECT_GT(k.size, 5.0f);
    EXPECT_LE(k.response, f.keypoints[i > 0 ? i - 1 : 0].response);
  }
}

TEST_P(EveryExtractor, DescriptorsHaveUnitNormOrZeroPadding) {
  const auto d = extract(params(), scene_).descriptors;
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (d.kind() == types::DescriptorKind::kFloat) {
      double norm = 0;
      for (int c = 0; c < d.dim(); ++c) norm += double(d.floats(i)[c]) * d.floats(i)[c];
      EXPECT_NEAR(norm, 1.0, 1e-5);
    } else {
      for (std::size_t bit = static_cast<std::size_t>(d.dim()); bit < d.rowBytes() * 8; ++bit)
        EXPECT_EQ(d.words(i)[bit / 64] >> (bit % 64) & 1u, 0u);
    }
  }
}

TEST_P(EveryExtractor, SameBytesFromSeveralThreads) {
  const auto extractor = makeExtractor(params());
  std::vector<types::Features> results(4);
  base::parallelFor(results.size(), 2, [&](std::size_t i) { results[i] = extractor->extract(scene_, {}); });
  for (const auto& r : results) EXPECT_TRUE(same(r, results[0]));
}

TEST_P(EveryExtractor, GreyAndColourAgree) {
  cv::Mat colour, withAlpha;
  cv::cvtColor(scene_, colour, cv::COLOR_GRAY2BGR);
  cv::cvtColor(scene_, withAlpha, cv::COLOR_GRAY2BGRA);
  const auto f = extract(params(), scene_);
  EXPECT_TRUE(same(f, extract(params(), colour)));
  EXPECT_TRUE(same(f, extract(params(), withAlpha)));
}

TEST_P(EveryExtractor, NothingToSeeIsNotAnError) {
  const auto extractor = makeExtractor(params());
  cv::Mat dot = cv::Mat::zeros(240, 320, CV_8U);
  dot.at<std::uint8_t>(100, 100) = 1;
  const std::vector<cv::Mat> images{cv::Mat(),
                                    cv::Mat::zeros(240, 320, CV_8U),
                                    cv::Mat(240, 320, CV_8UC3, cv::Scalar::all(255)),
                                    cv::Mat::eye(1, 1, CV_8U),
                                    cv::Mat::eye(5, 300, CV_8U),
                                    cv::Mat::eye(300, 3, CV_8U)};
  for (const auto& image : images) {
    const auto f = extractor->extract(image, {});
    EXPECT_TRUE(f.empty());
    EXPECT_EQ(f.descriptors.kind(), extractor->kind());
    EXPECT_EQ(f.descriptors.dim(), extractor->dim());
  }
  EXPECT_NO_THROW(extractor->extract(dot, {}));
  EXPECT_TRUE(extractor->extract(scene_, cv::Mat::zeros(scene_.size(), CV_8U)).empty());
}

TEST_P(EveryExtractor, SmallImagesOfAnyShape) {
  const auto extractor = makeExtractor(params());
  for (const int side : {24, 25, 31, 47, 64, 100})
    EXPECT_NO_THROW({
      extractor->extract(scene_(cv::Rect(0, 0, side, 130)), {});
      extractor->extract(scene_(cv::Rect(0, 0, 130, side)), {});
      extractor->extract(scene_(cv::Rect(7, 9, side, side)), {});
    });
}

TEST_P(EveryExtractor, RefusesWhatItCannotRead) {
  const auto extractor = makeExtractor(params());
  EXPECT_THROW(extractor->extract(cv::Mat::zeros(50, 50, CV_32F), {}), base::Error);
  EXPECT_THROW(extractor->extract(scene_, cv::Mat::ones(10, 10, CV_8U)), base::Error);
  EXPECT_THROW(extractor->extract(scene_, cv::Mat::ones(scene_.size(), CV_32F)), base::Error);
}

TEST_P(EveryExtractor, KeepsWholeRegionInsideTheMask) {
  auto p = params();
  p.mask_margin = 1.0;
  cv::Mat mask = cv::Mat::zeros(scene_.size(), CV_8U);
  const cv::Point centre(160, 120);
  const double radius = 110;
  cv::circle(mask, centre, static_cast<int>(radius), cv::Scalar(255), cv::FILLED);
  const auto f = extract(p, scene_, mask);
  ASSERT_GT(f.size(), 30u);
  const auto everywhere = extract(p, scene_);
  EXPECT_TRUE(std::any_of(everywhere.keypoints.begin(), everywhere.keypoints.end(), [&](const auto& k) {
    return cv::norm(cv::Point2f(k.x, k.y) - cv::Point2f(centre)) > radius;
  }));
  for (const auto& k : f.keypoints)
    EXPECT_LE(cv::norm(cv::Point2f(k.x, k.y) - cv::Point2f(centre)) + k.size / 2 * 0.96, radius + 1.5);
}

TEST_P(EveryExtractor, KeepsTheStrongest) {
  auto p = params();
  p.min_features = 0;
  const auto all = extract(p, scene_);
  p.max_features = 50;
  const auto few = extract(p, scene_);
  ASSERT_EQ(few.size(), 50u);
  // ORB selects by level before it returns, so only the others keep exactly the first fifty.
  if (p.extractor == "orb") return;
  for (std::size_t i = 0; i < few.size(); ++i)
    EXPECT_EQ(few.keypoints[i].response, all.keypoints[i].response);
}

TEST_P(EveryExtractor, SpreadsOverTheGrid) {
  auto p = params();
  p.max_features = 60;
  cv::Mat poster = scene_.clone();
  cv::Mat rest = poster(cv::Rect(80, 0, 240, 240));
  rest.convertTo(rest, -1, 0.5, 64);  // the left quarter has by far the strongest contrast
  const auto onPoster = [](const types::Features& f) {
    return std::count_if(f.keypoints.begin(), f.keypoints.end(), [](const auto& k) { return k.x < 80; });
  };
  const auto strongest = extract(p, poster);
  p.grid_cells = 4;
  const auto spread = extract(p, poster);
  EXPECT_GT(double(onPoster(strongest)), 1.4 * double(onPoster(spread)));
  EXPECT_EQ(spread.size(), 60u);
}

TEST_P(EveryExtractor, LowersItsThresholdInTheDark) {
  auto p = params();
  cv::Mat dark;
  scene_.convertTo(dark, -1, 0.08, 4);
  p.retries = 0;
  const auto once = extract(p, dark).size();
  p.retries = 3;
  const auto again = extract(p, dark).size();
  EXPECT_LT(once, 100u);
  EXPECT_GT(again, once + 50);
}

TEST_P(EveryExtractor, UprightHasNoAngleAndNoTwins) {
  auto p = params();
  p.upright = true;
  const auto f = extract(p, scene_);
  ASSERT_GT(f.size(), 100u);
  for (const auto& k : f.keypoints) EXPECT_EQ(k.angle, 0.0f);
  for (std::size_t i = 1; i < f.size(); ++i) {
    const auto &a = f.keypoints[i - 1], &b = f.keypoints[i];
    EXPECT_FALSE(a.x == b.x && a.y == b.y && a.size == b.size && a.response == b.response);
  }
}

TEST_P(EveryExtractor, AngleTurnsWithTheImage) {
  cv::Mat turned;
  cv::rotate(scene_, turned, cv::ROTATE_180);
  const auto a = extract(params(), scene_), b = extract(params(), turned);
  int pairs = 0, agree = 0;
  for (const auto& k : a.keypoints)
    for (const auto& q : b.keypoints) {
      if (std::hypot(319 - k.x - q.x, 239 - k.y - q.y) > 1 || std::abs(k.size - q.size) > 0.1f * k.size)
        continue;
      ++pairs;
      agree += std::cos(double(q.angle) - k.angle - std::numbers::pi) > 0.9;
    }
  ASSERT_GT(pairs, 50);
  EXPECT_GT(agree, 0.7 * pairs);
}

INSTANTIATE_TEST_SUITE_P(All, EveryExtractor, testing::Values("surf", "akaze", "orb", "sift"),
                         [](const auto& param_info) { return std::string(param_info.param); });

TEST(MakeExtractor, NamesABadValue) {
  ExtractorParams p;
  p.extractor = "brisk";
  EXPECT_THROW(makeExtractor(p), base::ConfigError);
  p.extractor = "akaze";
  p.max_features = 0;
  EXPECT_THROW(makeExtractor(p), base::ConfigError);
}

}  // namespace
}  // namespace engram::features
