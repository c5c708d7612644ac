// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <string>

namespace engram::apps {

/// Whether a target of --stream is a topic of a broker.
bool isMqtt(const std::string& target);

/// Results for other machines by MQTT. Under the topic of `mqtt://[user@]host[:port]/topic`:
///
///     topic/image   every line, as streamLine() has it; at most once
///     topic/pose    the last line whose pose is known; retained
///     topic/state   {"stream":"engram","version":1,"map":…,"state":"running"}; retained; `ended` at the end,
///                   and `lost` by the broker when the program has gone without a word
///
/// `mqtts://` is TLS with the certificates of the system. The password of a user is in the environment,
/// ENGRAM_MQTT_PASSWORD. A broker that is away or slow makes lines be missed; it never holds up the run. The
/// connection comes back by itself.
class MqttStream {
 public:
  /// @param hello object of the first line, without `state`
  /// Throws base::Error for an address that is none, and when the broker cannot be reached or refuses.
  MqttStream(const std::string& target, const std::string& hello);
  ~MqttStream();
  MqttStream(const MqttStream&) = delete;
  MqttStream& operator=(const MqttStream&) = delete;

  /// Returns at once.
  /// @param hasPose the line is kept as the last pose
  void send(const std::string& line, bool hasPose);
  /// Says that the run has ended, and waits half a second for what is on its way.
  void finish();
  /// Lines that the broker did not get.
  std::size_t missed() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace engram::apps
