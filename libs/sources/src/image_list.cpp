// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "image_list.h"

#include "engram/base/error.h"
#include "engram/sources/odometry_gate.h"
#include "engram/sources/rawlog_writer.h"
#include "image_codec.h"
#include "stamp_queue.h"

namespace engram::sources {
namespace {

double stampOf(const std::string& written, StampUnit unit) {
  const auto seconds = secondsOf(written, unit);
  if (!seconds) throw base::Error("the stamp '" + written + "' is no number of " + toString(unit));
  return *seconds;
}

class Source final : public ImageListSource {
 public:
  Source(std::string name, std::vector<ImageEntry> entries, ImageListNotes notes)
      : name_(std::move(name)), entries_(std::move(entries)), notes_(std::move(notes)) {}

  std::optional<types::Frame> next() override;
  double progress() const override { return static_cast<double>(at_) / static_cast<double>(entries_.size()); }
  std::string problem() const override;
  StampReading stampReading() const override { return notes_.reading; }
  std::string clockNote() const override;

 private:
  std::optional<types::Frame> read(const ImageEntry& entry);
  void readNext();

  std::string name_;
  std::vector<ImageEntry> entries_;
  ImageListNotes notes_;
  std::size_t at_ = 0, delivered_ = 0, unreadable_ = 0, impossibleStamps_ = 0, badPoses_ = 0;
  std::string firstFailure_;
  StampQueue<types::Frame> queue_;
};

/// None when an image of the entry cannot be read.
std::optional<types::Frame> Source::read(const ImageEntry& entry) {
  types::Frame frame;
  for (auto [path, image] : {std::pair(&entry.image, &frame.image), std::pair(&entry.right, &frame.right)}) {
    if (path->empty()) continue;
    Decoded decoded = readImageFile(*path);
    if (decoded.image.empty() && firstFailure_.empty())
      firstFailure_ = path->substr(path->rfind('/') + 1) + ": " + decoded.failure;
    *image = std::move(decoded.image);
  }
  if (frame.image.empty() || (!entry.right.empty() && frame.right.empty())) return std::nullopt;
  frame.stamp = entry.stamp;
  frame.label = entry.label;
  if (!entry.pose) return frame;
  const bool good = judgePose(*entry.pose) == PoseVerdict::kPass;
  badPoses_ += good ? 0 : 1;
  if (good) frame.T_odom_robot = toIsometry(*entry.pose);
  return frame;
}

void Source::readNext() {
  const ImageEntry& entry = entries_[at_++];
  const double stamp = stampAsRecorded(entry.stamp);  // what a rawlog of these frames will hold
  if (std::isnan(stamp)) return void(++impossibleStamps_);
  auto frame = read(entry);
  if (!frame) return void(++unreadable_);
  queue_.push(stamp, std::move(*frame));
}

std::optional<types::Frame> Source::next() {
  for (;;) {
    if (auto passed = queue_.pop()) {
      passed->item.index = delivered_++;
      return std::move(passed->item);
    }
    if (at_ == entries_.size()) return std::nullopt;
    readNext();
    if (at_ == entries_.size()) queue_.finish();
  }
}

std::string Source::problem() const {
  std::string text = notes_.problem;
  const auto say = [&text](std::size_t n, const std::string& what) {
    if (n > 0) text += (text.empty() ? "" : "; ") + std::to_string(n) + " " + what;
  };
  const StampCounts& stamps = queue_.counts();
  say(unreadable_, "image(s) left out: cannot be read (" + firstFailure_ + ")");
  say(stamps.bad - stamps.leaps, "image(s) left out: the stamp repeats or goes back");
  say(stamps.leaps, "image(s) left out: the stamp leaps ahead by more than a year, and the next ones do not");
  say(impossibleStamps_, "image(s) left out: a rawlog cannot hold the stamp (the years 1601 to 30827)");
  say(badPoses_, "image(s) with odometry that is not a number, or that no robot can have");
  return text.empty() ? text : name_ + ": " + text;
}

std::string Source::clockNote() const {
  const StampCounts& stamps = queue_.counts();
  std::string text;
  if (stamps.setBack > 0) text = "the clock was set back (" + std::to_string(stamps.setBack) + "x)";
  if (stamps.setAhead > 0)
    text += (text.empty() ? "" : "; ") + std::string("the clock leapt ahead by more than a year (") +
            std::to_string(stamps.setAhead) + "x)";
  return text.empty() ? text : text + ": time starts anew there, no image is lost";
}

}  // namespace

std::unique_ptr<ImageListSource> makeListSource(std::string name, std::vector<ImageEntry> entries,
                                                ImageListNotes notes) {
  return std::make_unique<Source>(std::move(name), std::move(entries), std::move(notes));
}

StampReading setStamps(std::vector<ImageEntry>& entries, const std::vector<std::string>& written,
                       StampUnit unit) {
  StampReading reading{unit, {}};
  if (unit == StampUnit::kAuto) {
    std::vector<double> numbers;
    for (const auto& text : written) numbers.push_back(stampOf(text, StampUnit::kSeconds));
    reading = tellStampUnit(numbers);
  }
  for (std::size_t i = 0; i < entries.size(); ++i) entries[i].stamp = stampOf(written[i], reading.unit);
  return reading;
}

}  // namespace engram::sources
