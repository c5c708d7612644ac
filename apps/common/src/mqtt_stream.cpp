// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/mqtt_stream.h"

#include "engram/base/error.h"

#include <nlohmann/json.hpp>

#include <atomic>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <mosquitto.h>
#include <mutex>
#include <thread>

namespace engram::apps {
namespace {

constexpr std::size_t kMostOnTheWay = 1000;  // messages that the broker has not taken yet
constexpr int kKeepAlive = 20;               // [s] of silence after which the broker asks
constexpr auto kPatience = std::chrono::seconds(5);
constexpr auto kLastWords = std::chrono::milliseconds(500);

struct BrokerAddress {
  bool tls = false;
  std::string user, host, topic;
  int port = 1883;
};

[[noreturn]] void failMqtt(const std::string& target, const std::string& what) {
  throw base::Error("--stream " + target + ": " + what);
}

int portOf(const std::string& target, const std::string& text) {
  int port = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (status != std::errc() || end != text.data() + text.size() || port < 1 || port > 65535)
    failMqtt(target, "'" + text + "' is no port");
  return port;
}

BrokerAddress brokerOf(const std::string& target) {
  BrokerAddress a;
  a.tls = target.starts_with("mqtts://");
  if (a.tls) a.port = 8883;
  std::string rest = target.substr(target.find("//") + 2);
  const auto slash = rest.find('/');
  if (slash == std::string::npos || slash + 1 == rest.size())
    failMqtt(target, "it needs a topic: mqtt://host/robots/anna");
  a.topic = rest.substr(slash + 1);
  if (a.topic.find_first_of("+#") != std::string::npos)
    failMqtt(target, "a topic to write to has no + and no #");
  rest.resize(slash);
  if (const auto at = rest.rfind('@'); at != std::string::npos) {
    a.user = rest.substr(0, at);
    rest.erase(0, at + 1);
    if (a.user.find(':') != std::string::npos)
      throw base::Error(
          "--stream: the address holds a password: put it into the environment, ENGRAM_MQTT_PASSWORD");
  }
  if (const auto colon = rest.rfind(':'); colon != std::string::npos) {
    a.port = portOf(target, rest.substr(colon + 1));
    rest.resize(colon);
  }
  if (rest.empty()) failMqtt(target, "it needs a host");
  a.host = rest;
  return a;
}

/// Made once for the process.
void startLibrary() {
  static const int status = mosquitto_lib_init();
  if (status != MOSQ_ERR_SUCCESS) throw base::Error(std::string("MQTT: ") + mosquitto_strerror(status));
}

}  // namespace

bool isMqtt(const std::string& target) {
  return target.starts_with("mqtt://") || target.starts_with("mqtts://");
}

class MqttStream::Impl {
 public:
  Impl(const std::string& target, const std::string& hello)
      : target_(target), address_(brokerOf(target)), hello_(nlohmann::ordered_json::parse(hello)) {
    startLibrary();
    client_.reset(mosquitto_new(nullptr, true, this));
    if (!client_) failMqtt(target, std::strerror(errno));
    configure();
    connect();
  }
  ~Impl() { finish(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void send(const std::string& line, bool hasPose) {
    if (!connected_ || published_ + kMostOnTheWay <= sent_) {
      ++missed_;
    } else {
      publish("image", line, 0, false);
    }
    if (!hasPose) return;
    const std::lock_guard lock(mutex_);
    lastPose_ = line;
    if (connected_ && published_ + kMostOnTheWay > sent_) publish("pose", line, 0, true);
  }

  void finish() {
    if (!running_) return;
    running_ = false;
    if (connected_) {
      publish("state", state("ended"), 1, true);
      const auto end = std::chrono::steady_clock::now() + kLastWords;
      const auto waitWhile = [&](const auto& holds) {
        while (holds() && std::chrono::steady_clock::now() < end)
          std::this_thread::sleep_for(std::chrono::milliseconds(5));
      };
      waitWhile([&] { return connected_ && published_ < sent_; });
      mosquitto_disconnect(client_.get());
      // Without this the thread may end before it has said good-bye, and the broker takes the robot for lost.
      waitWhile([&] { return connected_.load(); });
    }
    mosquitto_loop_stop(client_.get(), true);
  }

  std::size_t missed() const { return missed_; }

 private:
  void configure() {
    check(mosquitto_reconnect_delay_set(client_.get(), 1, 30, true));
    const std::string will = state("lost");
    check(mosquitto_will_set(client_.get(), topic("state").c_str(), static_cast<int>(will.size()),
                             will.data(), 1, true));
    if (!address_.user.empty())
      check(mosquitto_username_pw_set(client_.get(), address_.user.c_str(),
                                      std::getenv("ENGRAM_MQTT_PASSWORD")));
    if (address_.tls)
      check(mosquitto_tls_set(client_.get(), nullptr, "/etc/ssl/certs", nullptr, nullptr, nullptr));
    mosquitto_connect_callback_set(
        client_.get(), [](mosquitto*, void* self, int code) { static_cast<Impl*>(self)->onConnect(code); });
    mosquitto_disconnect_callback_set(
        client_.get(), [](mosquitto*, void* self, int) { static_cast<Impl*>(self)->onDisconnect(); });
    mosquitto_publish_callback_set(
        client_.get(), [](mosquitto*, void* self, int) { ++static_cast<Impl*>(self)->published_; });
  }

  void connect() {
    const int code = mosquitto_connect(client_.get(), address_.host.c_str(), address_.port, kKeepAlive);
    if (code != MOSQ_ERR_SUCCESS)
      failMqtt(target_, std::string("the broker cannot be reached: ") +
                            (code == MOSQ_ERR_ERRNO ? std::strerror(errno) : mosquitto_strerror(code)));
    check(mosquitto_loop_start(client_.get()));
    running_ = true;
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (!connected_ && refusal_ == 0 && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    if (connected_) return;
    running_ = false;
    mosquitto_disconnect(client_.get());
    mosquitto_loop_stop(client_.get(), true);
    failMqtt(target_, refusal_ != 0 ? std::string("the broker refuses: ") + mosquitto_connack_string(refusal_)
                                    : "the broker does not answer");
  }

  void onConnect(int code) {
    if (code != 0) {
      refusal_ = code;
      return;
    }
    sent_ = published_.load();
    publish("state", state("running"), 1, true);
    const std::lock_guard lock(mutex_);
    if (!lastPose_.empty()) publish("pose", lastPose_, 0, true);
    connected_ = true;  // last: "ended" must not get ahead of "running"
  }
  void onDisconnect() {
    // What was on its way is lost with the connection.
    if (connected_.exchange(false)) missed_ += sent_ - std::min(sent_.load(), published_.load());
  }

  void publish(const char* what, const std::string& text, int quality, bool retained) {
    ++sent_;
    const int code = mosquitto_publish(client_.get(), nullptr, topic(what).c_str(),
                                       static_cast<int>(text.size()), text.data(), quality, retained);
    if (code == MOSQ_ERR_SUCCESS) return;
    --sent_;
    ++missed_;
  }
  std::string topic(const std::string& what) const { return address_.topic + "/" + what; }
  std::string state(const char* word) const {
    nlohmann::ordered_json j = hello_;
    j["state"] = word;
    return j.dump();
  }
  void check(int code) const {
    if (code != MOSQ_ERR_SUCCESS) failMqtt(target_, mosquitto_strerror(code));
  }

  struct Destroy {
    void operator()(mosquitto* client) const { mosquitto_destroy(client); }
  };

  std::string target_;
  BrokerAddress address_;
  nlohmann::ordered_json hello_;
  std::mutex mutex_;
  std::string lastPose_;  // under mutex_
  std::atomic<bool> connected_{false}, running_{false};
  std::atomic<int> refusal_{0};
  std::atomic<std::size_t> sent_{0}, published_{0}, missed_{0};
  std::unique_ptr<mosquitto, Destroy> client_;
};

MqttStream::MqttStream(const std::string& target, const std::string& hello)
    : impl_(std::make_unique<Impl>(target, hello)) {}
MqttStream::~MqttStream() = default;
void MqttStream::send(const std::string& line, bool hasPose) { impl_->send(line, hasPose); }
void MqttStream::finish() { impl_->finish(); }
std::size_t MqttStream::missed() const { return impl_->missed(); }

}  // namespace engram::apps
