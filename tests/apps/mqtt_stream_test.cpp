// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/mqtt_stream.h"

#include "engram/apps/result_stream.h"
#include "engram/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <arpa/inet.h>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <mosquitto.h>
#include <mutex>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace engram::apps {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

constexpr const char* kBroker = "/usr/sbin/mosquitto";

int freePort() {
  const int s = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ::bind(s, reinterpret_cast<sockaddr*>(&address), sizeof address);
  socklen_t size = sizeof address;
  ::getsockname(s, reinterpret_cast<sockaddr*>(&address), &size);
  ::close(s);
  return ntohs(address.sin_port);
}

bool eventually(const std::function<bool()>& holds) {
  for (int i = 0; i < 2000; ++i, std::this_thread::sleep_for(5ms))
    if (holds()) return true;
  return false;
}

/// A real broker on loopback, which ends with this object.
class Broker {
 public:
  explicit Broker(const std::string& folder) : port(freePort()), config_(folder + "/mosquitto.conf") {
    std::ofstream(config_) << "listener " << port << " 127.0.0.1\nallow_anonymous true\n"
                           << (getuid() == 0 ? "user root\n" : "");
    start();
  }
  ~Broker() { stop(); }
  Broker(const Broker&) = delete;
  Broker& operator=(const Broker&) = delete;

  void start() {
    process_ = ::fork();
    if (process_ == 0) {
      ::execl(kBroker, kBroker, "-c", config_.c_str(), nullptr);
      ::_exit(127);
    }
    EXPECT_TRUE(eventually([&] {
      const int s = ::socket(AF_INET, SOCK_STREAM, 0);
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_port = htons(static_cast<std::uint16_t>(port));
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      const bool up = ::connect(s, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
      ::close(s);
      return up;
    }));
  }
  void stop() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = 0;
  }
  std::string target(const std::string& topic) const {
    return "mqtt://127.0.0.1:" + std::to_string(port) + "/" + topic;
  }

  const int port;

 private:
  std::string config_;
  pid_t process_ = 0;
};

/// Takes all messages of a broker.
class Subscriber {
 public:
  explicit Subscriber(int port) : client_(mosquitto_new(nullptr, true, this)) {
    mosquitto_message_callback_set(client_, [](mosquitto*, void* self, const mosquitto_message* m) {
      static_cast<Subscriber*>(self)->take(*m);
    });
    mosquitto_subscribe_callback_set(client_, [](mosquitto*, void* self, int, int, const int*) {
      static_cast<Subscriber*>(self)->ready_ = true;
    });
    EXPECT_EQ(mosquitto_connect(client_, "127.0.0.1", port, 20), MOSQ_ERR_SUCCESS);
    mosquitto_loop_start(client_);
    mosquitto_subscribe(client_, nullptr, "#", 1);
    EXPECT_TRUE(eventually([&] { return ready_.load(); }));
  }
  ~Subscriber() {
    mosquitto_disconnect(client_);
    mosquitto_loop_stop(client_, true);
    mosquitto_destroy(client_);
  }
  std::vector<std::string> of(const std::string& topic) const {
    const std::lock_guard lock(mutex_);
    const auto at = messages_.find(topic);
    return at == messages_.end() ? std::vector<std::string>{} : at->second;
  }
  bool has(const std::string& topic, const std::string& text) const {
    return eventually([&] {
      const auto all = of(topic);
      return !all.empty() && all.back().find(text) != std::string::npos;
    });
  }

 private:
  void take(const mosquitto_message& m) {
    const std::lock_guard lock(mutex_);
    messages_[m.topic].emplace_back(static_cast<const char*>(m.payload),
                                    static_cast<std::size_t>(m.payloadlen));
  }

  mosquitto* client_;
  std::atomic<bool> ready_{false};
  mutable std::mutex mutex_;
  std::map<std::string, std::vector<std::string>> messages_;
};

class MqttStreamTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { mosquitto_lib_init(); }
  void SetUp() override {
    if (!std::filesystem::exists(kBroker)) {
      ASSERT_EQ(std::getenv("CI"), nullptr) << "mosquitto is not installed: scripts/setup.sh does it";
      GTEST_SKIP() << "no mosquitto here: apt-get install mosquitto";
    }
    char name[] = "/tmp/engram_mqtt_XXXXXX";
    folder_ = mkdtemp(name);
    broker_ = std::make_unique<Broker>(folder_);
  }
  void TearDown() override {
    broker_.reset();
    if (!folder_.empty()) std::filesystem::remove_all(folder_);
  }
  static std::string hello() { return R"({"stream":"engram","version":1,"map":"office.engram"})"; }
  static std::string line(int index) {
    types::FrameReport report;
    report.index = static_cast<std::uint64_t>(index);
    return streamLine(report, StreamPose{{1, 2, 0}, 0.5});
  }

  std::string folder_;
  std::unique_ptr<Broker> broker_;
};

TEST_F(MqttStreamTest, LinesGoToImageAndTheLastPoseIsKept) {
  const Subscriber early(broker_->port);
  {
    MqttStream stream(broker_->target("robots/anna"), hello());
    for (int i = 0; i < 20; ++i) stream.send(line(i), i < 10);
    stream.finish();
    EXPECT_EQ(stream.missed(), 0u);
  }
  EXPECT_TRUE(early.has("robots/anna/state", "\"ended\""));
  EXPECT_TRUE(eventually([&] { return early.of("robots/anna/image").size() == 20; }));
  for (int i = 0; i < 20; ++i) EXPECT_EQ(early.of("robots/anna/image")[static_cast<std::size_t>(i)], line(i));
  const Subscriber late(broker_->port);
  EXPECT_TRUE(late.has("robots/anna/pose", "\"index\":9,"));
  EXPECT_TRUE(late.has("robots/anna/state", "office.engram"));
  EXPECT_TRUE(late.of("robots/anna/image").empty());
}

TEST_F(MqttStreamTest, TheBrokerTellsThatAProgramIsGone) {
  const pid_t robot = ::fork();
  if (robot == 0) {
    MqttStream stream(broker_->target("r"), hello());
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(robot, nullptr, 0);
  const Subscriber after(broker_->port);
  EXPECT_TRUE(after.has("r/state", "\"lost\""));
}

TEST_F(MqttStreamTest, ABrokerThatIsAwayHoldsNothingUpAndIsFoundAgain) {
  MqttStream stream(broker_->target("r"), hello());
  broker_->stop();
  EXPECT_TRUE(eventually([&] {
    stream.send(line(1), true);
    return stream.missed() > 0;
  }));
  for (int i = 0; i < 5000; ++i) stream.send(line(2), true);
  EXPECT_GE(stream.missed(), 5000u);
  broker_->start();
  const Subscriber subscriber(broker_->port);
  EXPECT_TRUE(subscriber.has("r/pose", "\"index\":2,"));  // comes by itself
  stream.send(line(3), true);
  EXPECT_TRUE(subscriber.has("r/image", "\"index\":3,"));
}

TEST_F(MqttStreamTest, WhatIsWrongIsSaid) {
  const auto opening = [](const std::string& target) { return [target] { MqttStream(target, hello()); }; };
  EXPECT_THAT(opening("mqtt://host"), ThrowsMessage<base::Error>(HasSubstr("needs a topic")));
  EXPECT_THAT(opening("mqtt:///a"), ThrowsMessage<base::Error>(HasSubstr("needs a host")));
  EXPECT_THAT(opening("mqtt://host:x/a"), ThrowsMessage<base::Error>(HasSubstr("no port")));
  EXPECT_THAT(opening("mqtt://host/a/#"), ThrowsMessage<base::Error>(HasSubstr("no #")));
  EXPECT_THAT(opening("mqtt://me:secret@host/a"),
              ThrowsMessage<base::Error>(AllOf(HasSubstr("ENGRAM_MQTT_PASSWORD"), Not(HasSubstr("secret")))));
  broker_->stop();
  EXPECT_THAT(opening(broker_->target("a")), ThrowsMessage<base::Error>(HasSubstr("cannot be reached")));
}

}  // namespace
}  // namespace engram::apps
