// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/held_text.h"
#include "engram/map/map_content.h"
#include "engram/pipeline/params.h"

#include <memory>

namespace engram::keeper {

/// The configuration and the calibration that a map was made with, ready for use.
struct Configuration {
  pipeline::PipelineParams params;
  std::shared_ptr<base::HeldText> camera;  ///< what `params.camera.file` names, where the map holds it
};

/// Throws base::ConfigError when the configuration in the map cannot be read.
/// @param name of the map, for messages
Configuration configurationOf(const map::MapHeader& header, const std::string& name);

}  // namespace engram::keeper
