// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "image_list.h"

#include "engram/sources/odometry_gate.h"
#include "engram/sources/stamp_gate.h"
#include "image_codec.h"

namespace engram::sources {
namespace {

class Source final : public FrameSource {
 public:
  Source(std::string name, std::vector<ImageEntry> entries, std::string notice)
      : name_(std::move(name)), entries_(std::move(entries)), notice_(std::move(notice)) {}

  std::optional<types::Frame> next() override;
  double progress() const override { return static_cast<double>(at_) / static_cast<double>(entries_.size()); }
  std::string problem() const override;

 private:
  std::string name_;
  std::vector<ImageEntry> entries_;
  std::string notice_;
  std::size_t at_ = 0, delivered_ = 0, unreadable_ = 0, badStamps_ = 0, badPoses_ = 0;
  std::string firstFailure_;
  StampGate gate_;
};

std::optional<types::Frame> Source::next() {
  while (at_ < entries_.size()) {
    const ImageEntry& entry = entries_[at_++];
    types::Frame frame;
    for (auto [path, image] :
         {std::pair(&entry.image, &frame.image), std::pair(&entry.right, &frame.right)}) {
      if (path->empty()) continue;
      Decoded decoded = readImageFile(*path);
      if (decoded.image.empty() && firstFailure_.empty())
        firstFailure_ = path->substr(path->rfind('/') + 1) + ": " + decoded.failure;
      *image = std::move(decoded.image);
    }
    if (frame.image.empty() || (!entry.right.empty() && frame.right.empty())) {
      ++unreadable_;
      continue;
    }
    const auto verdict = gate_.check(entry.stamp);
    if (verdict != StampGate::Verdict::kPass && verdict != StampGate::Verdict::kRestart) {
      ++badStamps_;
      continue;
    }
    frame.index = delivered_++;
    frame.stamp = entry.stamp;
    frame.label = entry.label;
    if (entry.pose) {
      const bool good = judgePose(*entry.pose) == PoseVerdict::kPass;
      badPoses_ += good ? 0 : 1;
      if (good) frame.T_odom_robot = toIsometry(*entry.pose);
    }
    return frame;
  }
  return std::nullopt;
}

std::string Source::problem() const {
  std::string text = notice_;
  const auto say = [&text](std::size_t n, const std::string& what) {
    if (n > 0) text += (text.empty() ? "" : "; ") + std::to_string(n) + " " + what;
  };
  say(unreadable_, "image(s) left out: cannot be read (" + firstFailure_ + ")");
  say(badStamps_, "image(s) left out: the stamp repeats or goes back");
  say(badPoses_, "image(s) with odometry that is not a number, or that no robot can have");
  return text.empty() ? text : name_ + ": " + text;
}

}  // namespace

std::unique_ptr<FrameSource> makeListSource(std::string name, std::vector<ImageEntry> entries,
                                            std::string notice) {
  return std::make_unique<Source>(std::move(name), std::move(entries), std::move(notice));
}

}  // namespace engram::sources
