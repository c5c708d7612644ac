// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/run_stream.h"

#include "engram/apps/program.h"
#include "engram/base/output_file.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <ostream>

namespace engram::apps {
namespace {

constexpr int kStreamVersion = 1;

double headingOf(const Eigen::Isometry3d& T) { return std::atan2(T.linear()(1, 0), T.linear()(0, 0)); }

}  // namespace

void RunStream::declare(CLI::App& app) {
  app.add_option(
         "--stream", targets_,
         "Send belief and pose of every image to other programs, as JSON lines: - is standard output, a "
         "path a Unix socket, mqtt://host/topic a broker (repeatable)")
      ->take_all()
      ->allow_extra_args(false)
      ->type_name("-|PATH|mqtt://HOST/TOPIC");
}

void RunStream::open(const std::string& map, std::ostream& notices) {
  for (const std::string& target : targets_) {
    if (isMqtt(target)) continue;
    if (!target_.empty())
      throw UsageError("--stream: standard output or one socket, beside any number of brokers");
    target_ = target;
  }
  const nlohmann::ordered_json hello = {{"stream", "engram"}, {"version", kStreamVersion}, {"map", map}};
  const std::string first = hello.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  for (const std::string& target : targets_)
    if (isMqtt(target)) brokers_.push_back(std::make_unique<MqttStream>(target, first));
  if (target_.empty()) return;
  notices_ = &notices;
  if (target_ == base::kStandardOutput) base::requireWritable(target_);
  stream_ = std::make_unique<ResultStream>(target_, first);
}

void RunStream::sendMapped(const types::FrameReport& report, const types::Frame& frame,
                           const map::TopologicalMap& map) {
  if (targets_.empty()) return;
  std::optional<Eigen::Isometry3d> fix;
  if (!map.path().empty() && map.path().back().stamp == frame.stamp) fix = map.T_map_robot(map.path().back());
  tracker_.update(fix, frame.T_odom_robot);
  std::optional<StreamPose> pose;
  if (const auto& T = tracker_.T_map_robot()) pose = {T->translation(), headingOf(*T)};
  send(report, pose);
}

void RunStream::sendLocalised(const types::FrameReport& report, const map::TopologicalMap& map) {
  if (targets_.empty()) return;
  std::optional<StreamPose> pose;
  if (report.pose)
    pose = {report.pose->T_map_robot.translation(), headingOf(report.pose->T_map_robot)};
  else if (report.outcome == types::Outcome::kRecognised)
    pose = {map.place(report.place).T_map_place.translation(), std::nullopt};
  send(report, pose);
}

/// Says once that readers wait, as soon as one does.
void RunStream::send(const types::FrameReport& report, const std::optional<StreamPose>& pose) {
  const std::string line = streamLine(report, pose);
  for (const auto& broker : brokers_) broker->send(line, pose.has_value());
  if (stream_) stream_->send(line);
  if (!stream_ || notices_ == nullptr || stream_->postponed() == 0) return;
  *notices_ << "--stream " << target_ << ": more readers than can be served (" << stream_->mostReaders()
            << " at most by ulimit -n, fewer when descriptors run out); others wait until one goes\n"
            << std::flush;
  notices_ = nullptr;
}

void RunStream::close(std::ostream& err) {
  for (const auto& broker : brokers_) {
    broker->finish();
    if (broker->missed() > 0) err << "--stream mqtt: the broker missed " << broker->missed() << " lines\n";
  }
  brokers_.clear();
  if (!stream_) return;
  const std::size_t missed = stream_->missed(), postponed = stream_->postponed();
  stream_->finish();
  const std::string failure = stream_->failure();
  failed_ = !failure.empty();
  stream_.reset();
  if (postponed > 0)
    err << "--stream " << target_ << ": readers had to wait (found " << postponed << " times)\n";
  if (failed_) err << "--stream " << target_ << ": lacks lines: " << failure << "\n";
  if (missed > 0) err << "--stream " << target_ << ": slow readers missed " << missed << " lines\n";
}

}  // namespace engram::apps
