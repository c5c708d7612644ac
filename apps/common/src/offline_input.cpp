// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/offline_input.h"

#include "engram/apps/checks.h"
#include "engram/apps/program.h"
#include "engram/base/error.h"
#include "engram/base/text.h"
#include "engram/sources/image_pairs.h"
#include "engram/sources/video_source.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace engram::apps {
namespace fs = std::filesystem;

void OfflineInput::declare(CLI::App& app) {
  app.add_option("--rawlog", rawlog_, "Rawlog with images, and odometry if there is any")->type_name("FILE");
  const auto images =
      app.add_option("--images", images_,
                     "Instead of a rawlog: folder of images, or folder and pattern (cam/*_0.jpg)")
          ->type_name("DIR");
  const auto right = app.add_option("--right", right_, "The same for the right eye of a stereo camera")
                         ->needs(images)
                         ->type_name("DIR");
  const auto stamps =
      app.add_option("--stamps", stamps_,
                     "names: the number in a file name is Unix time; else a file with one stamp "
                     "a line; default: one second apart")
          ->needs(images)
          ->type_name("names|FILE");
  app.add_option("--csv", csv_, "Images with columns image, stamp, right, x, y [m], yaw [rad]")
      ->needs(images)
      ->excludes(right)
      ->excludes(stamps)
      ->type_name("FILE");
  app.add_option("--video", video_, "Instead of a rawlog: a video")->type_name("FILE");
  app.add_option("--from", from_, "Number of the first image to use, from 0")->check(wholeFrom(0));
  app.add_option("--to", to_, "Number of the last image to use")->check(wholeFrom(0));
  app.add_option("--every", every_, "Use each n-th image only")->check(wholeFrom(1));
}

const std::string& OfflineInput::path() const {
  return !rawlog_.empty() ? rawlog_ : !images_.empty() ? images_ : video_;
}

std::string OfflineInput::name() const {
  const fs::path file(path());
  std::string text = (file.has_filename() ? file : file.parent_path()).filename().string();
  if (from_ > 0 || to_) text += " from " + std::to_string(from_) + (to_ ? " to " + std::to_string(*to_) : "");
  if (every_ > 1) text += " every " + std::to_string(every_);
  return text;
}

void OfflineInput::open(const sources::RawlogParams& params) {
  if (isOpen()) return;
  if (!rawlog_.empty() + !images_.empty() + !video_.empty() > 1)
    throw UsageError("--rawlog, --images and --video: give one of them");
  if (to_ && *to_ < from_) throw UsageError("--to is before --from: no image lies between them");
  if (!video_.empty()) {
    source_ = sources::openVideo(video_);
  } else if (!images_.empty()) {
    source_ = csv_.empty() ? sources::openImagePairs(images_, right_, stamps_)
                           : sources::openImageFolder(images_, csv_);
  } else {
    auto source = sources::openRawlog(rawlog_, params);
    rawlogSource_ = source.get();
    source_ = std::move(source);
  }
}

const types::Frame* OfflineInput::peek() {
  if (!peeked_) peeked_ = nextInRange();
  return peeked_ ? &*peeked_ : nullptr;
}

std::optional<types::Frame> OfflineInput::next() {
  return peeked_ ? std::exchange(peeked_, std::nullopt) : nextInRange();
}

std::optional<types::Frame> OfflineInput::nextInRange() {
  if (to_ && any_ && last_ >= *to_) return std::nullopt;
  while (auto frame = source_->next()) {
    ++seen_;
    if (to_ && frame->index > *to_) break;
    if (frame->index < from_ || (frame->index - from_) % every_ != 0) continue;
    last_ = frame->index;
    any_ = true;
    return frame;
  }
  return std::nullopt;
}

double OfflineInput::progress() const {
  if (!to_ || !any_) return source_->progress();
  const double share = static_cast<double>(last_ - from_ + 1) / static_cast<double>(*to_ - from_ + 1);
  return std::max(share, source_->progress());
}

std::string OfflineInput::problem() const {
  if (any_ || seen_ == 0) return source_->problem();
  return path() + ": has " + base::counted(seen_, "image") + ", none from number " + std::to_string(from_) +
         " on";
}

bool OfflineInput::whole() const {
  return rawlogSource_ != nullptr ? rawlogSource_->whole() : source_->problem().empty();
}

std::string OfflineInput::calibration(bool stereo) {
  if (rawlogSource_ == nullptr) return {};
  const types::Frame* first = peek();
  if (first == nullptr) return {};
  if (stereo) return rawlogSource_->calibration() ? cameras::toText(*rawlogSource_->calibration()) : "";
  const auto camera = rawlogSource_->camera();
  return camera && camera->camera->imageSize() == first->image.size() ? cameras::toText(*camera) : "";
}

}  // namespace engram::apps
