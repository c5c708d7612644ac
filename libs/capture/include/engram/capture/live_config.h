// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/config.h"
#include "engram/capture/gige_params.h"

#include <string>

namespace engram::capture {

/// A live camera with what belongs to it, as it stands in a configuration:
///
///     [front]                        [front.features]        [wheels]
///     driver = EngramGigECamera      BlackLevel = 3          driver = CMyOdometry   ; any sensor of MRPT
///     camera = Aravis-Fake-GV01                              process_rate = 50
///     odometry = wheels
struct LiveConfig {
  GigeParams camera;
  base::IniFile::Section odometry;  ///< section `camera.odometry`; empty when there is none
};

/// Takes the section `name`, its `.features` and its sensor of odometry out of `ini`. Without the section all
/// keys have their defaults if `optional`. Throws base::ConfigError like Config::read().
LiveConfig takeLiveConfig(base::IniFile& ini, const std::string& name, bool optional = false);

/// Takes all descriptions of sensors out of `ini`: sections with the key `driver`, and their `.features`.
void dropSensors(base::IniFile& ini);

}  // namespace engram::capture
