// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/sensor_reader.h"

#include "engram/base/error.h"

#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/core/exceptions.h>
#include <mrpt/hwdrivers/CGenericSensor.h>
#include <mrpt/hwdrivers/registerAllClasses.h>
#include <mrpt/system/os.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <thread>

namespace engram::capture {
namespace {

using mrpt::hwdrivers::CGenericSensor;

/// MRPT's exceptions carry a trace of calls, which says nothing to a user.
std::string firstLine(const std::string& message) {
  for (std::size_t begin = 0; begin < message.size();) {
    const std::size_t end = std::min(message.find('\n', begin), message.size());
    if (message.find_first_not_of(" \t=\r", begin) < end) return message.substr(begin, end - begin);
    begin = end + 1;
  }
  return message;
}

std::string valueOf(const base::IniFile::Section& section, const std::string& key) {
  const auto at = section.find(key);
  return at == section.end() ? std::string() : at->second.text;
}

std::string reasonOf(const std::exception& e) {
  const auto* mrptException = dynamic_cast<const mrpt::ExceptionWithCallBackBase*>(&e);
  return firstLine(mrptException ? mrptException->originalWhat : e.what());
}

CGenericSensor::Ptr create(const std::string& name, const std::string& driver) {
  if (driver.empty()) throw base::Error("[" + name + "] driver is missing: the class of an MRPT sensor");
  mrpt::hwdrivers::registerAllClasses_mrpt_hwdrivers();
  CGenericSensor::Ptr sensor;
  try {
    sensor = CGenericSensor::createSensorPtr(driver);
  } catch (const std::exception&) {
  }
  if (!sensor)
    throw base::Error("[" + name + "] driver = " + driver +
                      ": MRPT knows no such sensor; is the name right, and does it need a --plugin?");
  return sensor;
}

}  // namespace

class SensorReader::Impl {
 public:
  Impl(const std::string& name, const base::IniFile::Section& section, Sink sink)
      : name_(name), sink_(std::move(sink)), sensor_(create(name, valueOf(section, "driver"))) {
    mrpt::config::CConfigFileMemory config;
    for (const auto& [key, value] : section) config.write(name, key, value.text);
    try {
      sensor_->loadConfig(config, name);
      sensor_->initialize();
    } catch (const std::exception& e) {
      throw base::Error("[" + name + "] the sensor does not start: " + reasonOf(e));
    }
    if (!(sensor_->getProcessRate() > 0)) throw base::Error("[" + name + "] process_rate must be above 0 Hz");
    thread_ = std::thread([this] { run(); });
  }
  ~Impl() { stop(); }

  void stop() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
  }

  std::string failure() const {
    const std::lock_guard lock(mutex_);
    return failure_;
  }
  std::size_t objects() const { return objects_; }

 private:
  void run() {
    const auto period = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(1.0 / sensor_->getProcessRate()));
    auto next = std::chrono::steady_clock::now();
    try {
      while (!stopping_) {
        sensor_->doProcess();
        deliver();
        next = std::max(next + period, std::chrono::steady_clock::now());
        while (!stopping_ && std::chrono::steady_clock::now() < next)
          std::this_thread::sleep_until(
              std::min(next, std::chrono::steady_clock::now() + std::chrono::milliseconds(50)));
      }
    } catch (const std::exception& e) {
      const std::lock_guard lock(mutex_);
      failure_ = "[" + name_ + "] the sensor has failed: " + reasonOf(e);
    }
  }

  void deliver() {
    for (const auto& [stamp, object] : sensor_->getObservations()) {
      ++objects_;
      sink_(object);
    }
  }

  std::string name_;
  Sink sink_;
  CGenericSensor::Ptr sensor_;
  std::atomic<bool> stopping_{false};
  std::atomic<std::size_t> objects_{0};
  mutable std::mutex mutex_;
  std::string failure_;  // under mutex_
  std::thread thread_;
};

SensorReader::SensorReader(const std::string& name, const base::IniFile::Section& section, Sink sink)
    : impl_(std::make_unique<Impl>(name, section, std::move(sink))) {}
SensorReader::~SensorReader() = default;
void SensorReader::stop() { impl_->stop(); }
std::string SensorReader::failure() const { return impl_->failure(); }
std::size_t SensorReader::objects() const { return impl_->objects(); }

void loadSensorPlugins(const std::vector<std::string>& files) {
  for (const auto& file : files) {
    std::string why;
    if (!std::filesystem::exists(file)) throw base::Error(file + ": no such file");
    if (!mrpt::system::loadPluginModule(file, why))
      throw base::Error(file + ": cannot be loaded: " + firstLine(why));
  }
}

}  // namespace engram::capture
