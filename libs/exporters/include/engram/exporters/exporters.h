// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"

#include <string>

namespace engram::exporters {

// Each function writes the whole file beside `path` and renames it: readers see all of it or nothing. Each
// throws base::Error when the path exists and `overwrite` is false, or when it cannot be written.

struct SceneOptions {
  bool images = false;  ///< show thumbnails above their places, at most 180, evenly chosen
  bool overwrite = false;
};

/// The map for MRPT's SceneViewer3D: ground grid, places as spheres coloured by the number of long-term
/// features, edges coloured by type, the robot's path, place numbers. Metres.
void writeScene(const std::string& path, const map::TopologicalMap& map, const SceneOptions& options = {});

/// The pose graph as text, as MRPT's CNetworkOfPoses3DInf reads it and graph-slam shows it, with all digits.
/// Edges without scale have no form there and are left out.
void writeGraph(const std::string& path, const map::TopologicalMap& map, bool overwrite = false);

/// The robot's path in the TUM format, one keyframe a line: stamp [s], x y z [m], qx qy qz qw; in the map
/// frame.
void writeTum(const std::string& path, const map::TopologicalMap& map, bool overwrite = false);

/// The graph for Graphviz, places at their positions: `neato -n2 -Tsvg`.
void writeDot(const std::string& path, const map::TopologicalMap& map, bool overwrite = false);

}  // namespace engram::exporters
