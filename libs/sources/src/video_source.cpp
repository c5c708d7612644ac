// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/video_source.h"

#include "engram/base/error.h"

#include <opencv2/videoio.hpp>

#include <algorithm>
#include <filesystem>

namespace engram::sources {
namespace {

namespace fs = std::filesystem;

constexpr double kWhole = 0.95;  // share of the promised images, which many containers only estimate

class Video final : public FrameSource {
 public:
  explicit Video(const std::string& path) : path_(path), name_(fs::path(path).filename().string()) {
    std::error_code status;
    if (!fs::is_regular_file(path, status)) throw base::Error(path + ": no such video");
    if (!video_.open(path)) throw base::Error(path + ": is no video that can be read");
    promised_ = std::max(0.0, video_.get(cv::CAP_PROP_FRAME_COUNT));
    const double rate = video_.get(cv::CAP_PROP_FPS);
    if (rate > 0) interval_ = 1 / rate;
  }

  std::optional<types::Frame> next() override {
    types::Frame frame;
    if (ended_ || !video_.read(frame.image) || frame.image.empty()) {
      ended_ = true;
      return std::nullopt;
    }
    const double stamp = 1e-3 * video_.get(cv::CAP_PROP_POS_MSEC);
    frame.stamp = read_ > 0 && !(stamp > last_) ? last_ + interval_ : stamp;
    frame.index = read_++;
    frame.label = name_ + "#" + std::to_string(frame.index);
    last_ = frame.stamp;
    return frame;
  }

  double progress() const override {
    return promised_ > 0 ? std::min(1.0, static_cast<double>(read_) / promised_) : -1;
  }

  std::string problem() const override {
    if (!ended_ || (read_ > 0 && static_cast<double>(read_) >= kWhole * promised_)) return {};
    return path_ + ": ends after " + std::to_string(read_) + " of about " +
           std::to_string(static_cast<long>(promised_)) + " images";
  }

 private:
  std::string path_, name_;
  cv::VideoCapture video_;
  double promised_ = 0, interval_ = 1.0 / 30, last_ = 0;  // [images], [s], [s]
  std::uint64_t read_ = 0;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<FrameSource> openVideo(const std::string& path) { return std::make_unique<Video>(path); }

}  // namespace engram::sources
