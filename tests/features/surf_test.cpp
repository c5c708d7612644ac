// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "dlib_surf.h"
#include "engram/base/rng.h"
#include "engram/features/matching.h"
#include "hessian.h"
#include "integral_image.h"
#include "scene.h"
#include "surf_descriptor.h"
#include "surf_detector.h"
#include "surf_extractor.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <numbers>

namespace engram::features {
namespace {

using test::Photometry;

/// A Gaussian of the given amplitude on grey 128.
cv::Mat blob(cv::Size size, cv::Point2d centre, double sigma, double amplitude) {
  cv::Mat image(size, CV_8U);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double r2 = (x - centre.x) * (x - centre.x) + (y - centre.y) * (y - centre.y);
      image.at<std::uint8_t>(y, x) =
          cv::saturate_cast<std::uint8_t>(128 + amplitude * std::exp(-r2 / (2 * sigma * sigma)));
    }
  return image;
}

types::Keypoint strongestOf(const std::vector<types::Keypoint>& keypoints) {
  if (keypoints.empty()) return {};
  return *std::max_element(keypoints.begin(), keypoints.end(),
                           [](const auto& a, const auto& b) { return a.response < b.response; });
}

types::Features surf(const cv::Mat& image, int count, bool upright = false) {
  ExtractorParams p;
  p.max_features = count;
  p.upright = upright;
  return makeSurfExtractor(p, supportedSimd())->extract(image, {});
}

TEST(IntegralImage, SumsEveryRectangle) {
  base::Rng rng(1);
  cv::Mat image(13, 29, CV_8U);
  for (auto& v : cv::Mat_<std::uint8_t>(image)) v = static_cast<std::uint8_t>(rng.below(256));
  const IntegralImage integral(image);
  for (int y0 = 0; y0 <= 13; ++y0)
    for (int y1 = y0; y1 <= 13; ++y1)
      for (int x0 = 0; x0 <= 29; x0 += 3)
        for (int x1 = x0; x1 <= 29; x1 += 2) {
          const cv::Rect r(x0, y0, x1 - x0, y1 - y0);
          const double expected = r.area() ? cv::sum(image(r))[0] : 0;
          const std::uint32_t sum =
              integral.row(y1)[x1] - integral.row(y1)[x0] - integral.row(y0)[x1] + integral.row(y0)[x0];
          EXPECT_EQ(sum, static_cast<std::uint32_t>(expected));
        }
}

// The response to a Gaussian blob at its centre, from error functions: the box sums are integrals of the
// Gaussian.
TEST(Hessian, BlobResponseHasItsClosedForm) {
  const double amplitude = 100, sigma = 4;
  const cv::Mat image = blob({101, 101}, {50, 50}, sigma, amplitude);
  const IntegralImage integral(image);
  const auto integralTo = [&](int pixels) {  // over -pixels … pixels, one dimension
    return sigma * std::sqrt(2 * std::numbers::pi) * std::erf((pixels + 0.5) / (sigma * std::numbers::sqrt2));
  };
  for (const int lobe : {3, 5, 7, 9, 13, 17, 25}) {
    const BoxFilter f{lobe};
    std::vector<float> row(101, 0.0f);
    HessianRows(SimdLevel::kPortable, integral).compute(f, 50, 1, row.data());
    const double area = 255.0 * f.size() * f.size();
    const double dxx = amplitude * (integralTo(f.half()) - 3 * integralTo(lobe / 2)) * integralTo(lobe - 1) /
                       area;  // = Dyy; Dxy = 0
    EXPECT_NEAR(row[50], dxx * dxx, 0.03 * dxx * dxx) << f.size();
    EXPECT_EQ(laplacianSign(integral, f, 50, 50), -1);
  }
}

TEST(Hessian, AllLevelsAndStepsGiveTheSameBits) {
  for (const int width : {60, 61, 77, 131}) {
    const cv::Mat image = test::texturedScene(width, 90, 5);
    const IntegralImage integral(image);
    for (const int step : {1, 2, 4})
      for (const int lobe : {3, 5, 9, 17}) {
        std::vector<float> dense(static_cast<std::size_t>(width), -1.0f), a = dense, b = dense;
        HessianRows(SimdLevel::kPortable, integral).compute({lobe}, 40, 1, dense.data());
        HessianRows(SimdLevel::kPortable, integral).compute({lobe}, 40, step, a.data());
        HessianRows(supportedSimd(), integral).compute({lobe}, 40, step, b.data());
        EXPECT_EQ(a, b);
        for (int x = 0; x * step < width; ++x) EXPECT_EQ(a[std::size_t(x)], dense[std::size_t(x * step)]);
      }
  }
}

TEST(FindMaxima, EqualsBruteForceWithTies) {
  base::Rng rng(7);
  for (int trial = 0; trial < 300; ++trial) {
    const int n = 3 + static_cast<int>(rng.below(60));
    std::vector<float> values[3][3];
    Neighbourhood hood{};
    for (int l = 0; l < 3; ++l)
      for (int r = 0; r < 3; ++r) {
        for (int x = 0; x < n; ++x)
          values[l][r].push_back(static_cast<float>(rng.below(trial % 2 ? 4 : 1000)));
        hood.rows[l][r] = values[l][r].data();
      }
    std::vector<int> expected;
    for (int x = 1; x < n - 1; ++x) {
      bool largest = values[1][1][std::size_t(x)] > 2;
      for (int i = 0; i < 27; ++i) {
        const float c = values[1][1][std::size_t(x)],
                    v = values[i / 9][i / 3 % 3][std::size_t(x + i % 3 - 1)];
        largest &= i < 13 ? c > v : c >= v;
      }
      if (largest) expected.push_back(x);
    }
    for (const auto level : {SimdLevel::kPortable, supportedSimd()}) {
      std::vector<int> found;
      findMaxima(level, hood, 1, n - 1, 2.0f, found);
      EXPECT_EQ(found, expected);
    }
  }
}

/// Scale [px] at which box filters of continuous size answer a Gaussian blob most: from the closed form above
/// with lobes of l pixels, which stand for the scale 0.4 l.
double blobScale(double sigma) {
  double best = 0, bestLobe = 0;
  for (double lobe = 1; lobe < 6 * sigma; lobe += 0.01) {
    const auto part = [&](double halfWidth) { return std::erf(halfWidth / (sigma * std::numbers::sqrt2)); };
    const double response =
        std::abs((part(1.5 * lobe) - 3 * part(lobe / 2)) * part(lobe - 0.5)) / (lobe * lobe);
    if (response > best) {
      best = response;
      bestLobe = lobe;
    }
  }
  return 0.4 * bestLobe;
}

TEST(DetectSurf, FindsABlobAtItsPlaceAndScale) {
  base::Rng rng(3);
  for (const double sigma : {2.5, 3.5, 5.0, 7.0, 10.0, 14.0})
    for (const double amplitude : {90.0, -90.0}) {
      const cv::Point2d centre(150 + rng.uniform(-4, 4), 140 + rng.uniform(-4, 4));
      const auto k = strongestOf(
          detectSurf(SimdLevel::kPortable, IntegralImage(blob({300, 280}, centre, sigma, amplitude)), {}));
      EXPECT_NEAR(k.x, centre.x, 0.1 + 0.05 * sigma);
      EXPECT_NEAR(k.y, centre.y, 0.1 + 0.05 * sigma);
      EXPECT_NEAR(k.size / kSurfWindow, blobScale(sigma), 0.08 * sigma) << sigma;
      EXPECT_EQ(k.sign, amplitude > 0 ? -1 : 1);
    }
}

TEST(Surf, AllLevelsGiveTheSameBits) {
  base::Rng rng(9);
  for (int trial = 0; trial < 12; ++trial) {
    ExtractorParams p;
    p.surf_step = 1 + trial % 2;
    p.upright = trial % 3 == 0;
    const cv::Mat image =
        test::texturedScene(24 + int(rng.below(300)), 24 + int(rng.below(200)), 20 + std::uint64_t(trial));
    const auto a = makeSurfExtractor(p, SimdLevel::kPortable)->extract(image, {});
    const auto b = makeSurfExtractor(p, supportedSimd())->extract(image, {});
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(a.descriptors, b.descriptors);
    for (std::size_t i = 0; i < a.size(); ++i) {
      const auto &k = a.keypoints[i], &q = b.keypoints[i];
      EXPECT_TRUE(k.x == q.x && k.y == q.y && k.size == q.size && k.angle == q.angle &&
                  k.response == q.response && k.sign == q.sign);
    }
  }
}

// Box filters and the sampling grid (320 and 240 are multiples of all steps) map onto themselves.
TEST(Surf, QuarterTurnMapsTheKeypointsExactly) {
  const cv::Mat image = test::texturedScene(321, 241, 4);
  cv::Mat turned;
  cv::rotate(image, turned, cv::ROTATE_90_CLOCKWISE);  // (x, y) to (240 - y, x)
  const auto a = surf(image, 100000), b = surf(turned, 100000);
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 200u);
  int found = 0, alike = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) {
      const auto &k = a.keypoints[i], &q = b.keypoints[j];
      if (std::hypot(240 - k.y - q.x, k.x - q.y) > 1e-2 || std::abs(k.size - q.size) > 1e-2) continue;
      ++found;
      double squares = 0;
      for (int c = 0; c < kSurfDim; ++c)
        squares += std::pow(a.descriptors.floats(i)[c] - b.descriptors.floats(j)[c], 2);
      alike += std::cos(q.angle - k.angle - std::numbers::pi / 2) > 0.99 && squares < 0.01;
    }
  EXPECT_EQ(found, static_cast<int>(a.size()));
  EXPECT_GT(alike, 0.95 * found);
}

struct View {
  const char* name;
  double degrees, scale;
  Photometry photometry;
  bool upright;
};

class SurfAgainstDlib : public testing::TestWithParam<View> {};

TEST_P(SurfAgainstDlib, RepeatsAndMatchesNotWorse) {
  const View view = GetParam();
  test::Agreement ours, theirs;
  const auto add = [](test::Agreement& sum, const test::Agreement& one) {
    sum.visible += one.visible;
    sum.repeated += one.repeated;
    sum.matches += one.matches;
    sum.correct += one.correct;
  };
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const cv::Mat image = test::texturedScene(400, 300, seed);
    const cv::Matx33d H = test::similarity(image.size(), view.degrees * std::numbers::pi / 180, view.scale);
    const cv::Mat other = test::warped(image, H, view.photometry, seed);
    const auto da = test::dlibSurf(image, 400), db = test::dlibSurf(other, 400);
    // Equal numbers of features on both sides, or more of them would repeat by chance.
    const auto a = surf(image, int(da.size()), view.upright), b = surf(other, int(db.size()), view.upright);
    add(theirs, test::compare(test::points(da), test::points(db), match(da, db, {}), H, image.size(), 2.5));
    add(ours, test::compare(test::points(a), test::points(b), match(a, b, {}), H, image.size(), 2.5));
  }
  RecordProperty("ours", std::to_string(ours.repeatability()) + " " + std::to_string(ours.correct));
  RecordProperty("dlib", std::to_string(theirs.repeatability()) + " " + std::to_string(theirs.correct));
  EXPECT_GE(ours.repeatability(), theirs.repeatability());
  EXPECT_GE(ours.correct, theirs.correct);
  EXPECT_GE(ours.precision(),
            theirs.precision() - 0.03);  // of more matches: dlib leaves out the image border
  EXPECT_GT(ours.repeatability(), 0.5);
  EXPECT_GT(ours.precision(), 0.85);
}

INSTANTIATE_TEST_SUITE_P(
    Views, SurfAgainstDlib,
    testing::Values(View{"same", 0, 1, {1, 0, 2}, false}, View{"upright", 0, 1, {1, 0, 2}, true},
                    View{"turn30", 30, 1, {}, false}, View{"turn77", 77, 1, {1, 0, 3}, false},
                    View{"turn180", 180, 1, {}, false}, View{"larger", 10, 1.3, {}, false},
                    View{"smaller", -20, 0.75, {}, false}, View{"darker", 5, 1, {0.5, 10, 2}, false},
                    View{"noisy", 15, 1, {1, 0, 10}, false}),
    [](const auto& param_info) { return std::string(param_info.param.name); });

}  // namespace
}  // namespace engram::features
