// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"
#include "engram/types/frame.h"
#include "engram/types/frame_report.h"
#include "panel.h"

#include <Eigen/Core>

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace engram::viewer {

/// The shape of a map: what the window draws of it.
struct MapSketch {
  struct Place {
    Eigen::Vector3f at;  ///< [m]
    std::uint32_t id = 0;
    bool current = false;  ///< the robot is there
  };
  struct Line {
    Eigen::Vector3f a, b;
    map::EdgeType type = map::EdgeType::kOdometry;
  };
  std::vector<Place> places;
  std::vector<Line> edges;
  std::vector<Eigen::Vector3f> path;     ///< the last part of it, newest last
  std::optional<Eigen::Vector3f> robot;  ///< where it is; none when it is lost
};

/// Everything that the window needs of one image: values, so that the run goes on meanwhile.
struct Snapshot {
  cv::Mat image;
  types::FrameReport report;
  RobotState state = RobotState::kBlind;
  MapSketch map;
  std::optional<memory::PlaceMemory> memory;  ///< of the place where the image was recognised or made
  std::vector<std::uint8_t> matchedJpeg;      ///< thumbnail of that place, or of the best guess
};

/// Takes snapshots; remembers where the thumbnails are.
class Snapper {
 public:
  Snapshot take(const types::Frame& frame, const types::FrameReport& report, RobotState state,
                const map::TopologicalMap& map);

 private:
  const std::vector<std::uint8_t>* thumbnailOf(base::PlaceId place, const map::TopologicalMap& map);

  std::map<base::PlaceId, base::ViewId> thumbnails_;
  std::optional<base::ViewId> lastView_;
};

}  // namespace engram::viewer
