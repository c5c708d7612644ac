// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/mqtt_stream.h"
#include "engram/apps/pose_tracker.h"
#include "engram/apps/result_stream.h"
#include "engram/map/topological_map.h"
#include "engram/types/frame.h"
#include "engram/types/frame_report.h"

#include <CLI/CLI.hpp>

#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace engram::apps {

/// --stream: what a run finds, for other programs.
class RunStream {
 public:
  void declare(CLI::App& app);
  /// @param map path of the map, for the first line
  /// @param notices takes, while the stream is open, what a person should know at once
  void open(const std::string& map, std::ostream& notices);

  /// A mapping run: the pose is that of the robot's path.
  void sendMapped(const types::FrameReport& report, const types::Frame& frame,
                  const map::TopologicalMap& map);
  /// A localising run: the pose is that of the place where the image was recognised, its heading is not
  /// known.
  void sendLocalised(const types::FrameReport& report, const map::TopologicalMap& map);

  /// Where a summary for people goes: standard output is taken when the stream goes there.
  std::ostream& summaryTo(std::ostream& out, std::ostream& err) const { return target_ == "-" ? err : out; }
  /// Ends the stream; says how many lines readers missed.
  void close(std::ostream& err);
  /// After close(): lines are missing on standard output.
  bool failed() const { return failed_; }

 private:
  void send(const types::FrameReport& report, const std::optional<StreamPose>& pose);

  std::vector<std::string> targets_;
  std::string target_;               // that is no broker
  std::ostream* notices_ = nullptr;  // none, or none any more
  bool failed_ = false;
  std::unique_ptr<ResultStream> stream_;
  std::vector<std::unique_ptr<MqttStream>> brokers_;
  PoseTracker tracker_;
};

}  // namespace engram::apps
