// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/rawlog_source.h"

#include "engram/base/error.h"
#include "engram/sources/odometry_gate.h"
#include "rawlog_parser.h"
#include "rawlog_problem.h"
#include "stamp_queue.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <limits>

namespace engram::sources {
namespace {

namespace fs = std::filesystem;

std::string imagesFolder(const std::string& path, const RawlogParams& params) {
  if (!params.images_dir.empty()) return params.images_dir;
  const fs::path file(path);
  const std::string stem = file.stem().string();
  // The first that is there, in the order in which MRPT looks for them.
  for (const std::string& name : {stem + "_Images", stem + "_images", std::string("Images")})
    if (fs::is_directory(file.parent_path() / name)) return (file.parent_path() / name).string();
  return (file.parent_path() / (stem + "_Images")).string();
}

class Source final : public RawlogSource {
 public:
  Source(const std::string& path, const RawlogParams& params)
      : path_(path), params_(params), folder_(imagesFolder(path, params)), parser_(path) {}

  std::optional<types::Frame> next() override;
  double progress() const override { return progress_; }
  std::string problem() const override {
    return describeProblem(path_, parser_.damage(), stats_, params_, label_.value_or(""));
  }
  const RawlogStats& stats() const override { return stats_; }
  const std::optional<cameras::StereoRig>& calibration() const override { return calibration_; }
  std::optional<cameras::CameraRig> camera() const override {
    return camera_ ? std::optional(toRig(*camera_)) : std::nullopt;
  }
  std::string damage() const override { return parser_.damage(); }

 private:
  enum class Kind { kUnknown, kObservation, kAction };

  void readOne();
  void noteProgress();
  void take(ImageRecord&& record);
  void take(const OdometryRecord& record);
  void take(const ActionRecord& record);
  void take(NameRecord&& record);
  void take(const OtherRecord&) {}
  void accept(ImageRecord&& record);
  std::string takeName(const ImageRecord& image);
  void noteRefusals();
  bool useKind(Kind kind);
  bool plausible(PoseVerdict verdict);
  void addSample(double stamp, const Pose2& pose);
  void noteStamp(double stamp);
  bool ready(const ImageRecord& record) const;
  bool paired(const ImageRecord& record) const;
  std::deque<ImageRecord>::iterator nearestRight(double stamp);
  bool attachRight(ImageRecord& record);
  std::optional<types::Frame> deliver(ImageRecord record);

  std::string path_;
  RawlogParams params_;
  std::string folder_;
  RawlogParser parser_;
  RawlogStats stats_;
  bool finished_ = false;
  double progress_ = 0.0;
  bool hasStamp_ = false;

  std::optional<std::string> label_;  // of the camera in use
  StampQueue<ImageRecord> images_;
  std::deque<NameRecord> names_;  // waiting for their images
  std::deque<ImageRecord> pending_;
  std::deque<ImageRecord> rights_;  // of a camera of its own, waiting for their left ones
  std::optional<cameras::StereoRig> calibration_;
  std::optional<RecordedCamera> camera_;

  Kind kind_ = Kind::kUnknown;
  std::optional<std::string> odometryLabel_;
  StampQueue<Pose2> samples_;
  OdometryTrack track_;
  Pose2 pose_;        // the last sample, or the sum of the increments
  Pose2 atMeasured_;  // up to where the path was measured
  bool hasPose_ = false, hasMeasured_ = false;
  std::size_t odometryNoStamp_ = 0;
  bool poseLacksStamp_ = false;  // increments whose end has no stamp but that of the next image
};

std::optional<types::Frame> Source::next() {
  for (;;) {
    while (!pending_.empty() && (finished_ || ready(pending_.front()))) {
      ImageRecord record = std::move(pending_.front());
      pending_.pop_front();
      auto frame = deliver(std::move(record));
      noteProgress();
      if (frame) return frame;
    }
    noteProgress();
    if (finished_) return std::nullopt;
    readOne();
  }
}

/// By images: those that are read but wait to be delivered are still to come.
void Source::noteProgress() {
  const auto read = static_cast<double>(stats_.images + pending_.size());
  const double share = read > 0 ? static_cast<double>(stats_.images) / read : 1.0;
  progress_ = std::max(progress_, share * parser_.progress());
}

void Source::readOne() {
  auto record = parser_.next();
  if (record) std::visit([this](auto&& r) { take(std::forward<decltype(r)>(r)); }, std::move(*record));
  finished_ = !record;
  if (!finished_) return;
  images_.finish();
  samples_.finish();
  noteRefusals();
  stats_.objects = parser_.counts();
}

bool Source::ready(const ImageRecord& record) const {
  if (pending_.size() >= static_cast<std::size_t>(params_.look_ahead)) return true;
  return paired(record) && (params_.odometry == "none" || track_.covers(record.stamp));
}

/// Whether no later right image can be the partner.
bool Source::paired(const ImageRecord& record) const {
  return params_.right_label.empty() || (!rights_.empty() && rights_.back().stamp >= record.stamp);
}

std::deque<ImageRecord>::iterator Source::nearestRight(double stamp) {
  return std::min_element(rights_.begin(), rights_.end(), [stamp](const auto& a, const auto& b) {
    return std::abs(a.stamp - stamp) < std::abs(b.stamp - stamp);
  });
}

/// Finds the right image of a left one; false when there is none, which is counted.
bool Source::attachRight(ImageRecord& record) {
  const auto at = nearestRight(record.stamp);
  const double gap =
      at == rights_.end() ? std::numeric_limits<double>::infinity() : std::abs(at->stamp - record.stamp);
  if (gap > params_.pair_tolerance) {
    if (stats_.imagesUnpaired++ == 0) stats_.nearestRight = gap;
    return false;
  }
  record.right = std::move(at->image);
  record.rightCamera = at->camera;
  record.stereo = true;
  rights_.erase(rights_.begin(), at + 1);
  return true;
}

void Source::noteStamp(double stamp) {
  stats_.firstStamp = hasStamp_ ? std::min(stats_.firstStamp, stamp) : stamp;
  stats_.lastStamp = hasStamp_ ? std::max(stats_.lastStamp, stamp) : stamp;
  hasStamp_ = true;
}

void Source::take(ImageRecord&& record) {
  ++stats_.cameras[record.label];
  if (!params_.right_label.empty() && record.label == params_.right_label) {
    if (std::isnan(record.stamp)) return;
    if (rights_.size() >= 2 * static_cast<std::size_t>(params_.look_ahead)) rights_.pop_front();
    rights_.push_back(std::move(record));
    return;
  }
  if (!label_ && (params_.sensor_label.empty() || record.label == params_.sensor_label))
    label_ = record.label;
  if (!label_ || record.label != *label_) return;
  if (std::isnan(record.stamp)) {
    ++stats_.imagesNoStamp;
    record.stamp = std::isnan(images_.last()) ? 0.0 : images_.last() + 1.0;
  }
  record.name = takeName(record);
  const double stamp = record.stamp;
  images_.push(stamp, std::move(record));
  while (auto passed = images_.pop()) accept(std::move(passed->item));
  noteRefusals();
}

void Source::accept(ImageRecord&& record) {
  noteStamp(record.stamp);
  if (poseLacksStamp_) addSample(record.stamp, pose_);
  poseLacksStamp_ = false;
  pending_.push_back(std::move(record));
}

void Source::noteRefusals() {
  const StampCounts &images = images_.counts(), &samples = samples_.counts();
  stats_.imagesBadStamp = images.bad;
  stats_.imagesLeap = images.leaps;
  stats_.clockRestarts = std::max(images.setBack, samples.setBack);
  stats_.clockLeaps = std::max(images.setAhead, samples.setAhead);
  stats_.odometryBadStamp = samples.bad + odometryNoStamp_;
}

void Source::take(NameRecord&& record) {
  constexpr std::size_t kWaiting = 64;  // a name stands just before its image
  if (names_.size() == kWaiting) names_.pop_front();
  names_.push_back(std::move(record));
}

/// The name that a comment gave to this image, the last one with its stamp; empty when none did.
std::string Source::takeName(const ImageRecord& image) {
  const auto found = std::find_if(names_.rbegin(), names_.rend(),
                                  [&](const NameRecord& name) { return name.stamp == image.stamp; });
  if (found == names_.rend()) return {};
  std::string name = std::move(found->name);
  names_.erase(names_.begin(), found.base());
  return name;
}

bool Source::useKind(Kind kind) {
  if (params_.odometry == "none") return false;
  if (params_.odometry == "observation" && kind != Kind::kObservation) return false;
  if (params_.odometry == "action" && kind != Kind::kAction) return false;
  if (kind_ == Kind::kUnknown) kind_ = kind;
  return kind_ == kind;
}

/// Whether to use a reading; what is left out is counted.
bool Source::plausible(PoseVerdict verdict) {
  stats_.odometryBad += verdict == PoseVerdict::kNotFinite;
  stats_.odometryWild += verdict == PoseVerdict::kWild;
  return verdict == PoseVerdict::kPass;
}

void Source::take(const OdometryRecord& record) {
  const bool wanted = params_.odometry_label.empty() || record.label == params_.odometry_label;
  if (wanted && !odometryLabel_) odometryLabel_ = record.label;
  if (!wanted || record.label != *odometryLabel_ || !useKind(Kind::kObservation))
    return void(++stats_.odometryOther);
  if (std::isnan(record.stamp)) return void(++odometryNoStamp_);
  if (!plausible(judgePose(record.pose))) return;
  addSample(record.stamp, record.pose);
}

void Source::take(const ActionRecord& record) {
  if (!useKind(Kind::kAction)) return void(++stats_.odometryOther);
  if (!plausible(judgeStep(record.increment))) return;
  // The path begins where the images before the first action were taken.
  if (!hasPose_ && !std::isnan(images_.last())) addSample(images_.last(), Pose2{});
  if (!hasPose_) pose_ = Pose2{};
  const Pose2 now = compose(pose_, record.increment);
  if (std::isnan(record.stamp)) {
    stats_.pathLength += std::hypot(record.increment.x, record.increment.y);
    ++stats_.odometry;
    pose_ = atMeasured_ = now;
    hasPose_ = hasMeasured_ = poseLacksStamp_ = true;
    return;
  }
  addSample(record.stamp, now);
  pose_ = now;  // even when the stamp was refused: the motion took place
  hasPose_ = true;
}

void Source::addSample(double stamp, const Pose2& pose) {
  samples_.push(stamp, pose);
  while (const auto passed = samples_.pop()) {
    if (passed->restart) track_.clear();
    const Pose2& to = passed->item;
    if (hasMeasured_) stats_.pathLength += std::hypot(to.x - atMeasured_.x, to.y - atMeasured_.y);
    ++stats_.odometry;
    noteStamp(passed->stamp);
    track_.add(passed->stamp, to);
    pose_ = atMeasured_ = to;
    hasPose_ = hasMeasured_ = true;
  }
  noteRefusals();
}

std::optional<types::Frame> Source::deliver(ImageRecord record) {
  const auto fail = [&](const Decoded& bad) {
    ++(bad.missing ? stats_.imagesMissing : stats_.imagesDamaged);
    if (stats_.firstFailure.empty()) stats_.firstFailure = bad.failure;
    return std::nullopt;
  };
  if (!params_.right_label.empty() && !attachRight(record)) return std::nullopt;
  types::Frame frame;
  Decoded left = decode(record.image, folder_);
  if (left.image.empty()) return fail(left);
  frame.image = std::move(left.image);
  if (record.stereo) {
    Decoded right = decode(record.right, folder_);
    if (right.image.empty()) return fail(right);
    frame.right = std::move(right.image);
    calibration_.reset();
    if (record.camera && record.rightCamera) calibration_ = toStereoRig(*record.camera, *record.rightCamera);
  }
  camera_ = record.stereo ? std::nullopt : record.camera;
  frame.index = stats_.images++;
  frame.stamp = record.stamp;
  frame.label = record.image.kind == EncodedImage::Kind::kExternal ? record.image.path : record.label;
  if (!record.name.empty()) frame.label = record.name;
  if (const auto pose = track_.at(record.stamp, params_.odometry_hold))
    frame.T_odom_robot = toIsometry(*pose);
  if (!frame.T_odom_robot && !track_.empty()) ++stats_.imagesNoOdometry;
  return frame;
}

}  // namespace

std::unique_ptr<RawlogSource> openRawlog(const std::string& path, const RawlogParams& params) {
  base::validate(params);
  return std::make_unique<Source>(path, params);
}

}  // namespace engram::sources
