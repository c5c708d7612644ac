// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/bags/bag_source.h"

#include "bag_camera.h"
#include "bag_scan.h"
#include "engram/base/error.h"
#include "engram/base/text.h"

#include <algorithm>
#include <cmath>
#include <deque>

namespace engram::bags {
namespace {

constexpr std::size_t kMostWaiting = 64;  // images of one eye that wait for the other

std::string topicList(const BagScan& scan) {
  std::string text;
  for (const auto& topic : scan.topics)
    text += "\n  " + base::printable(topic.name) + " (" + base::printable(topic.type) + ", " +
            base::counted(topic.messages, "message") + ")";
  return text.empty() ? " The bag holds no topics." : " The bag holds:" + text;
}

/// The topic of the images without the part that tells how they are sent.
std::string rawTopic(const std::string& topic) {
  constexpr std::string_view kCompressed = "/compressed";
  return topic.ends_with(kCompressed) ? topic.substr(0, topic.size() - kCompressed.size()) : topic;
}

std::string calibrationTopic(const std::string& imageTopic) {
  const std::string raw = rawTopic(imageTopic);
  return raw.substr(0, raw.rfind('/') == std::string::npos ? 0 : raw.rfind('/')) + "/camera_info";
}

bool isRectified(const std::string& topic) { return topic.find("image_rect") != std::string::npos; }

bool holds(const std::vector<std::string>& list, const std::string& value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

/// The topics of images that may be meant: no depth, and none that is sent raw as well.
std::vector<std::string> cameraTopics(const BagScan& scan) {
  std::vector<std::string> all, meant;
  for (const auto& topic : scan.topics)
    if (isImageType(topic.type) && topic.messages > 0) all.push_back(topic.name);
  for (const auto& topic : all) {
    const bool depth = topic.find("depth") != std::string::npos || topic.find("Depth") != std::string::npos;
    if (!depth && (rawTopic(topic) == topic || !holds(all, rawTopic(topic)))) meant.push_back(topic);
  }
  return meant;
}

/// "/stereo/left/image" as "/stereo/right/image".
std::string rightOf(std::string topic) {
  const auto at = topic.rfind("left");
  return at == std::string::npos ? "" : topic.replace(at, 4, "right");
}

void chooseCameras(const std::string& path, const BagScan& scan, BagSourceParams& params) {
  const auto meant = cameraTopics(scan);
  if (params.image.empty()) {
    if (meant.size() == 1) params.image = meant[0];
    for (const auto& left : meant)
      if (meant.size() == 2 && holds(meant, rightOf(left))) params.image = left, params.right = rightOf(left);
    if (params.image.empty())
      throw base::Error(
          path + (meant.empty() ? ": no topic of images." : ": which camera? Name its topic with --image.") +
          topicList(scan));
  }
  for (const auto& topic : {params.image, params.right})
    if (!topic.empty() && !scan.imageFrames.contains(topic))
      throw base::Error(path + ": no images of the topic " + base::quoted(topic) + "." + topicList(scan));
}

class BagReaderSource final : public BagSource {
 public:
  BagReaderSource(const std::string& path, const BagSourceParams& params)
      : path_(path), params_(params), scan_(scanBag(path)) {
    chooseCameras(path_, scan_, params_);
    chooseOdometry();
    chooseBase();
    notes_.push_back("images of " + params_.image + (params_.right.empty() ? "" : " and " + params_.right));
    calibrate();
    if (scan_.unreadable > 0)
      notes_.push_back(base::counted(scan_.unreadable, "message") + " could not be read and were left out");
    reader_ = openBag(path_);
  }

  std::optional<types::Frame> next() override;
  double progress() const override { return reader_->progress(); }
  std::string problem() const override {
    if (!reader_->problem().empty()) return reader_->problem();
    if (unusable_ > 0)
      return path_ + ": " + base::counted(unusable_, "image") + " left out: " + firstFailure_;
    return "";
  }
  const std::optional<cameras::CameraRig>& camera() const override { return camera_; }
  const std::optional<cameras::StereoRig>& stereo() const override { return stereo_; }
  const std::vector<std::string>& notes() const override { return notes_; }
  std::size_t imagesUnusable() const override { return unusable_; }
  std::size_t imagesUnpaired() const override { return unpaired_; }

 private:
  void chooseOdometry();
  void chooseBase();
  void calibrate();
  std::optional<cameras::CameraRig> rigOf(const std::string& topic);
  void takeImage(const BagMessage& message, const BagTopic& topic);
  std::optional<types::Frame> pair();
  types::Frame toFrame(const RosImage& left, const cv::Mat& right);

  std::string path_;
  BagSourceParams params_;
  BagScan scan_;
  const BagOdometry* odometry_ = nullptr;
  std::optional<cameras::CameraRig> camera_;
  std::optional<cameras::StereoRig> stereo_;
  std::vector<std::string> notes_;
  std::unique_ptr<BagReader> reader_;
  std::deque<RosImage> left_, right_;  // wait for the other eye
  std::size_t frames_ = 0, unusable_ = 0, unpaired_ = 0;
  std::string firstFailure_;
};

void BagReaderSource::chooseOdometry() {
  if (params_.odometry == "none") return;
  std::string chosen;
  for (const auto& [topic, odometry] : scan_.odometry) {
    const bool tf = topic.starts_with("tf ");
    const bool wanted = params_.odometry.empty()
                            ? !tf || chosen.empty()
                            : topic == params_.odometry || (tf && params_.odometry == "tf");
    if (!wanted) continue;
    if (!chosen.empty() && !chosen.starts_with("tf ") && !tf)
      throw base::Error(path_ + ": which odometry? Name its topic with --odometry, or none." +
                        topicList(scan_));
    chosen = topic;
  }
  if (chosen.empty() && !params_.odometry.empty())
    throw base::Error(path_ + ": no odometry of " + base::quoted(params_.odometry) + "." + topicList(scan_));
  if (chosen.empty()) return notes_.push_back("no odometry");
  odometry_ = &scan_.odometry.at(chosen);
  notes_.push_back(base::counted(odometry_->size(), "reading") + " of odometry of " + chosen);
  if (params_.base_frame.empty())
    params_.base_frame = chosen.starts_with("tf ") ? chosen.substr(3) : scan_.robotFrames[chosen];
}

void BagReaderSource::chooseBase() {
  for (const char* usual : {"base_link", "base_footprint"})
    if (params_.base_frame.empty() &&
        (scan_.parents.contains(usual) ||
         std::any_of(scan_.parents.begin(), scan_.parents.end(),
                     [&](const auto& each) { return each.second.header.frame == usual; })))
      params_.base_frame = usual;
}

/// Without mount.
std::optional<cameras::CameraRig> BagReaderSource::rigOf(const std::string& topic) {
  const auto found = scan_.calibrations.find(calibrationTopic(topic));
  if (found == scan_.calibrations.end()) {
    notes_.push_back("no calibration: " + calibrationTopic(topic) + " has no message");
    return std::nullopt;
  }
  try {
    return toRig(found->second, isRectified(topic));
  } catch (const base::Error& e) {
    notes_.push_back("no calibration: " + found->first + " cannot be used: " + e.what());
    return std::nullopt;
  }
}

void BagReaderSource::calibrate() {
  camera_ = rigOf(params_.image);
  if (!camera_) return;
  const std::string& frame = scan_.imageFrames[params_.image];
  if (const auto mount = scan_.mount(params_.base_frame, frame)) {
    camera_->T_robot_cam = *mount;
    notes_.push_back("mount: " + frame + " on " + params_.base_frame);
  } else {
    notes_.push_back(
        "mount not known: no transforms join " + base::quoted(frame) + " and the robot" +
        (params_.base_frame.empty() ? " (--base-frame)" : " " + base::quoted(params_.base_frame)) +
        "; the camera is taken to look forward");
  }
  if (params_.right.empty()) return;
  auto right = rigOf(params_.right);
  if (!right) return;
  auto T_left_right =
      leftToRight(scan_.calibrations.at(calibrationTopic(params_.image)),
                  scan_.calibrations.at(calibrationTopic(params_.right)), isRectified(params_.image));
  if (!T_left_right) T_left_right = scan_.mount(frame, scan_.imageFrames[params_.right]);
  if (!T_left_right)
    return notes_.push_back(
        "no stereo calibration: neither P of the right camera_info nor transforms tell the baseline");
  right->T_robot_cam = camera_->T_robot_cam * *T_left_right;
  stereo_ = cameras::StereoRig{*camera_, *right};
}

void BagReaderSource::takeImage(const BagMessage& message, const BagTopic& topic) {
  const bool isRight = topic.name == params_.right;
  if (!isImageType(topic.type) || (!isRight && topic.name != params_.image)) return;
  RosImage image;
  try {
    image = readImage(message, topic);
  } catch (const base::Error& e) {
    image.failure = e.what();
  }
  if (image.image.empty()) {
    if (unusable_++ == 0) firstFailure_ = topic.name + ": " + image.failure;
    return;
  }
  if (!(image.header.stamp > 0)) image.header.stamp = 1e-9 * static_cast<double>(message.received);
  auto& queue = isRight ? right_ : left_;
  queue.push_back(std::move(image));
  if (queue.size() <= kMostWaiting) return;
  queue.pop_front();
  ++unpaired_;
}

types::Frame BagReaderSource::toFrame(const RosImage& left, const cv::Mat& right) {
  types::Frame frame;
  frame.index = frames_++;
  frame.stamp = left.header.stamp;
  frame.label = params_.image;
  frame.image = left.image;
  frame.right = right;
  if (odometry_ != nullptr) frame.T_odom_robot = odometry_->at(frame.stamp);
  return frame;
}

/// The older of the two that wait goes when it is too far from the other: both topics come in order of time.
std::optional<types::Frame> BagReaderSource::pair() {
  if (params_.right.empty()) {
    if (left_.empty()) return std::nullopt;
    const RosImage image = std::move(left_.front());
    left_.pop_front();
    return toFrame(image, {});
  }
  while (!left_.empty() && !right_.empty()) {
    const double apart = left_.front().header.stamp - right_.front().header.stamp;
    if (std::abs(apart) <= params_.sync) {
      const RosImage left = std::move(left_.front()), right = std::move(right_.front());
      left_.pop_front(), right_.pop_front();
      return toFrame(left, right.image);
    }
    (apart < 0 ? left_ : right_).pop_front();
    ++unpaired_;
  }
  return std::nullopt;
}

std::optional<types::Frame> BagReaderSource::next() {
  for (;;) {
    if (auto frame = pair()) return frame;
    const auto message = reader_->next();
    if (!message) break;
    takeImage(*message, reader_->topics()[message->topic]);
  }
  unpaired_ += left_.size() + right_.size();
  left_.clear(), right_.clear();
  return std::nullopt;
}

}  // namespace

std::unique_ptr<BagSource> openBagSource(const std::string& path, const BagSourceParams& params) {
  return std::make_unique<BagReaderSource>(path, params);
}

}  // namespace engram::bags
