// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/config.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mrpt::serialization {
class CSerializable;
}

namespace engram::capture {

/// Runs one sensor of MRPT (any CGenericSensor) in a thread of its own.
class SensorReader {
 public:
  using Object = std::shared_ptr<mrpt::serialization::CSerializable>;
  /// Called from the thread of the sensor; may block.
  using Sink = std::function<void(const Object&)>;

  /// @param name of the section, for messages
  /// @param section as rawlog-grabber reads it: `driver` is the class of the sensor, `process_rate` in Hz
  /// Throws base::Error when the class is unknown or the sensor cannot be started.
  SensorReader(const std::string& name, const base::IniFile::Section& section, Sink sink);
  ~SensorReader();
  SensorReader(const SensorReader&) = delete;
  SensorReader& operator=(const SensorReader&) = delete;

  /// No object comes after this returns.
  void stop();
  /// Why no more objects come, as a message for the user; empty while they may.
  std::string failure() const;
  std::size_t objects() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Loads shared libraries that register classes of sensors. Throws base::Error with the linker's reason.
void loadSensorPlugins(const std::vector<std::string>& files);

}  // namespace engram::capture
