// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/world/world.h"
#include "rawlog_file.h"

#include <iosfwd>
#include <string>
#include <vector>

namespace engram::apps {

struct DataSetOptions {
  std::string folder;
  int sessions = 8;
  bool testDrive = false;
  bool overwrite = false;
  bool quiet = false;
  int threads = 1;
  std::string preset;  ///< for world.json
  RawlogLayout layout = RawlogLayout::kObservations;
  bool externalImages = false;
};

/// What was made.
struct DataSetFigures {
  int sessions = 0;
  std::size_t images = 0;
  double seconds = 0;
  double msPerFrame = 0;  ///< rendering and encoding, per image (a stereo pair is one)
  bool stopped = false;   ///< by Ctrl-C: the sessions before are complete
};

/// Writes `session_NN.rawlog`, `.truth.tum`, `.places.csv` for every session, `test.*` when wanted,
/// `camera.ini`
/// (`camera_left.ini` and `camera_right.ini` for stereo), `plan.png` and `world.json`. Every file is written
/// beside and renamed: after an interruption there are whole sessions or nothing. Throws base::Error; refuses
/// existing files.
DataSetFigures makeDataSet(const world::World& world, const world::Eyes& eyes, const DataSetOptions& options,
                           std::ostream& err);

}  // namespace engram::apps
