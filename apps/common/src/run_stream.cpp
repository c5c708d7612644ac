// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/run_stream.h"

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
  app.add_option("--stream", target_,
                 "Send belief and pose of every image to other programs, as JSON lines: - is "
                 "standard output, a path a Unix socket")
      ->type_name("-|PATH");
}

void RunStream::open(const std::string& map, std::ostream& notices) {
  if (target_.empty()) return;
  notices_ = &notices;
  if (target_ == base::kStandardOutput) base::requireWritable(target_);
  const nlohmann::ordered_json hello = {{"stream", "engram"}, {"version", kStreamVersion}, {"map", map}};
  stream_ = std::make_unique<ResultStream>(
      target_, hello.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

void RunStream::sendMapped(const types::FrameReport& report, const types::Frame& frame,
                           const map::TopologicalMap& map) {
  if (!stream_) return;
  std::optional<Eigen::Isometry3d> fix;
  if (!map.path().empty() && map.path().back().stamp == frame.stamp) fix = map.T_map_robot(map.path().back());
  tracker_.update(fix, frame.T_odom_robot);
  std::optional<StreamPose> pose;
  if (const auto& T = tracker_.T_map_robot()) pose = {T->translation(), headingOf(*T)};
  send(streamLine(report, pose));
}

void RunStream::sendLocalised(const types::FrameReport& report, const map::TopologicalMap& map) {
  if (!stream_) return;
  std::optional<StreamPose> pose;
  if (report.pose)
    pose = {report.pose->T_map_robot.translation(), headingOf(report.pose->T_map_robot)};
  else if (report.outcome == types::Outcome::kRecognised)
    pose = {map.place(report.place).T_map_place.translation(), std::nullopt};
  send(streamLine(report, pose));
}

/// Says once that readers wait, as soon as one does.
void RunStream::send(const std::string& line) {
  stream_->send(line);
  if (notices_ == nullptr || stream_->postponed() == 0) return;
  *notices_ << "--stream " << target_ << ": more readers than can be served (" << stream_->mostReaders()
            << " at most by ulimit -n, fewer when descriptors run out); others wait until one goes\n"
            << std::flush;
  notices_ = nullptr;
}

void RunStream::close(std::ostream& err) {
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
