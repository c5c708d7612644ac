// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/mqtt_stream.h"
#include "engram/base/error.h"

namespace engram::apps {

class MqttStream::Impl {};

bool isMqtt(const std::string& target) {
  return target.starts_with("mqtt://") || target.starts_with("mqtts://");
}

MqttStream::MqttStream(const std::string& target, const std::string&) {
  throw base::Error("--stream " + target + ": this program was built without libmosquitto");
}
MqttStream::~MqttStream() = default;
void MqttStream::send(const std::string&, bool) {}
void MqttStream::finish() {}
std::size_t MqttStream::missed() const { return 0; }

}  // namespace engram::apps
