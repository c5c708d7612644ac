// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "report_pictures.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cstdint>

namespace engram::apps {
namespace {

constexpr int kWidth = 240;  // [px]
constexpr int kQuality = 80;

std::vector<std::uint8_t> picture(const cv::Mat& image) {
  const int width = std::min(kWidth, image.cols);
  const int height = std::max(1, cvRound(static_cast<double>(image.rows) * width / image.cols));
  cv::Mat small;
  cv::resize(image, small, {width, height}, 0, 0, cv::INTER_AREA);
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", small, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  return jpeg;
}

}  // namespace

void ReportPictures::add(const types::FrameReport& report, const types::Frame& frame) {
  if (!report.closure && report.outcome != types::Outcome::kRecognised) return;
  Sample& sample = report.closure ? closures_ : recognised_;
  if (sample.seen++ % sample.every != 0) return;
  sample.kept.push_back({{report.index, report.stamp}, picture(frame.image)});
  if (sample.kept.size() <= kMost) return;
  std::size_t n = 0;
  std::erase_if(sample.kept, [&n](const auto&) { return n++ % 2 == 1; });
  sample.every *= 2;
}

exporters::Pictures ReportPictures::all() const {
  exporters::Pictures pictures(closures_.kept.begin(), closures_.kept.end());
  pictures.insert(recognised_.kept.begin(), recognised_.kept.end());
  return pictures;
}

}  // namespace engram::apps
