// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// SURF against dlib's SURF: repeatability and correct matches between real images and warped copies of them.
//   surf_comparison FOLDER...      folders of images; ten of each, spread evenly, are used
#include "dlib_surf.h"
#include "engram/features/extractor.h"
#include "engram/features/matching.h"
#include "scene.h"

#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

namespace {

using namespace engram;
using namespace engram::features;

constexpr int kImages = 10, kCount = 550;
constexpr double kTolerance = 2.5;  // [px]

struct View {
  const char* name;
  double degrees, scale, tilt;
  test::Photometry photometry;
};
const std::vector<View> kViews{{"turn 20", 20, 1, 0, {1, 0, 2}},      {"turn 75", 75, 1, 0, {1, 0, 2}},
                               {"scale 1.25", 5, 1.25, 0, {1, 0, 2}}, {"scale 0.75", -5, 0.75, 0, {1, 0, 2}},
                               {"tilt", 0, 1, 4e-4, {1, 0, 2}},       {"light x 0.6", 3, 1, 0, {0.6, 10, 2}},
                               {"noise 10", 3, 1.05, 0, {1, 0, 10}}};

struct Row {
  test::Agreement agreement;
  std::size_t features = 0, images = 0;
  double milliseconds = 0;
};

using Extract = std::function<types::Features(const cv::Mat&, int)>;

types::Features timed(const Extract& extract, const cv::Mat& image, int count, Row& row) {
  const auto start = std::chrono::steady_clock::now();
  auto f = extract(image, count);
  row.milliseconds +=
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  row.features += f.size();
  ++row.images;
  return f;
}

void add(Row& row, const types::Features& a, const types::Features& b, const cv::Matx33d& H, cv::Size size) {
  const auto one = test::compare(test::points(a), test::points(b), match(a, b, {}), H, size, kTolerance);
  row.agreement.visible += one.visible;
  row.agreement.repeated += one.repeated;
  row.agreement.matches += one.matches;
  row.agreement.correct += one.correct;
}

std::vector<cv::Mat> load(const std::string& folder) {
  std::vector<cv::String> files;
  cv::glob(folder, files);
  std::vector<cv::Mat> images;
  for (const auto& file : files)
    if (cv::haveImageReader(file)) images.push_back(cv::imread(file, cv::IMREAD_GRAYSCALE));
  std::vector<cv::Mat> some;
  const std::size_t step = std::max<std::size_t>(1, images.size() / kImages);
  for (std::size_t i = 0; i < images.size() && some.size() < kImages; i += step) {
    const double factor = std::min(1.0, 640.0 / images[i].cols);
    cv::Mat small;
    cv::resize(images[i], small, {}, factor, factor, cv::INTER_AREA);
    some.push_back(small);
  }
  return some;
}

void print(const char* view, const char* name, const Row& row) {
  std::printf("  %-12s %-6s %8.0f %10.3f %8d %8d %9.3f %8.2f\n", view, name,
              double(row.features) / double(row.images), row.agreement.repeatability(), row.agreement.matches,
              row.agreement.correct, row.agreement.precision(), row.milliseconds / double(row.images));
}

void compareOn(const std::string& folder) {
  const auto images = load(folder);
  std::printf("%s: %zu images\n  %-12s %-6s %8s %10s %8s %8s %9s %8s\n", folder.c_str(), images.size(),
              "view", "", "features", "repeated", "matches", "correct", "precision", "ms");
  const Extract engram = [](const cv::Mat& image, int count) {
    ExtractorParams p;
    p.max_features = std::max(1, count);
    p.surf_threshold = 1e-6;  // as many as dlib's, whatever the contrast
    return makeExtractor(p)->extract(image, {});
  };
  for (const auto& view : kViews) {
    Row ours, theirs;
    for (const auto& image : images) {
      cv::Matx33d H = test::similarity(image.size(), view.degrees * std::numbers::pi / 180, view.scale);
      H(2, 0) = view.tilt;
      const cv::Mat other = test::warped(image, H, view.photometry, 1);
      const auto da = timed(test::dlibSurf, image, kCount, theirs),
                 db = timed(test::dlibSurf, other, kCount, theirs);
      // Equal numbers on both sides, or more features would repeat by chance.
      const auto a = timed(engram, image, int(da.size()), ours),
                 b = timed(engram, other, int(db.size()), ours);
      add(theirs, da, db, H, image.size());
      add(ours, a, b, H, image.size());
    }
    print(view.name, "engram", ours);
    print("", "dlib", theirs);
  }
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  if (argc < 2) {
    std::fprintf(stderr, "usage: surf_comparison FOLDER...\n");
    return 2;
  }
  for (int i = 1; i < argc; ++i) compareOn(argv[i]);
  return 0;
}
