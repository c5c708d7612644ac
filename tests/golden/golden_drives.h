// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/pipeline/params.h"
#include "engram/types/frame.h"

#include <ostream>
#include <string>
#include <vector>

namespace engram::testing {

/// A shipped configuration and the camera of the tiny world that suits it.
struct GoldenCase {
  std::string config;                    ///< name of a file in config/, without .ini
  std::string eye;                       ///< omni, pinhole, pano or stereo
  std::vector<std::string> overrides{};  ///< `section.key=value`, for what no file ships
  std::string suffix{};                  ///< of the name, with overrides
  std::string name() const { return config + suffix; }
};

/// For the messages of a test.
inline void PrintTo(const GoldenCase& golden, std::ostream* out) { *out << golden.name(); }

/// The first day, and another one weeks later with other light, posters and furniture: small parts of both.
struct GoldenDrives {
  std::vector<types::Frame> first, second;
};

/// Rendered once per test binary.
const GoldenDrives& goldenDrives(const std::string& eye);

/// The configuration as a program reads it, without its live cameras.
pipeline::PipelineParams goldenParams(const GoldenCase& golden);

}  // namespace engram::testing
