// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/live_config.h"

#include "engram/base/error.h"
#include "engram/capture/sensor_reader.h"

#include <gmock/gmock.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <chrono>
#include <mutex>
#include <thread>

namespace engram::capture {
namespace {

using ::testing::HasSubstr;
using ::testing::Pair;
using ::testing::UnorderedElementsAre;
using namespace std::chrono_literals;

constexpr const char* kText = R"([front]
driver = EngramGigECamera
camera = Aravis-Fake-GV01
exposure_us = 1500
odometry = wheels
process_rate = 40
[front.features]
rawlog-grabber-ignore = true
BlackLevel = 3
GainAuto = Off
[wheels]
driver = CircleOdometry
process_rate = 100
speed = 2
sensorLabel = WHEELS
[rear]
driver = EngramGigECamera
[rear.features]
Gain = 1
[camera]
fov = 60
)";

template <class Work>
std::string messageOf(Work&& work) {
  try {
    work();
  } catch (const base::Error& e) {
    return e.what();
  }
  return {};
}

TEST(LiveConfig, TakesTheCameraWithItsFeaturesAndItsOdometry) {
  base::IniFile ini = base::IniFile::parse(kText, "robot.ini");
  const LiveConfig live = takeLiveConfig(ini, "front");
  EXPECT_EQ(live.camera.camera, "Aravis-Fake-GV01");
  EXPECT_EQ(live.camera.exposure_us, 1500);
  EXPECT_THAT(live.camera.features, UnorderedElementsAre(Pair("BlackLevel", "3"), Pair("GainAuto", "Off")));
  EXPECT_EQ(live.odometry.at("speed").text, "2");
  dropSensors(ini);
  ASSERT_EQ(ini.sections().size(), 1u);  // the rest is for the strict reader
  EXPECT_TRUE(ini.sections().contains("camera"));
}

TEST(LiveConfig, IsStrict) {
  const auto complaint = [](const std::string& text, const std::string& name) {
    base::IniFile ini = base::IniFile::parse(text, "robot.ini");
    return messageOf([&] { takeLiveConfig(ini, name); });
  };
  EXPECT_THAT(complaint(kText, "fromt"), HasSubstr("no section [fromt]"));
  EXPECT_THAT(complaint(kText, "fromt"), HasSubstr("did you mean [front]?"));
  EXPECT_THAT(complaint("[a]\nexposur_us = 3\n", "a"), HasSubstr("did you mean 'exposure_us'?"));
  EXPECT_THAT(complaint("[a]\nexposure_us = -3\n", "a"), HasSubstr("robot.ini:2: [a] exposure_us"));
  EXPECT_THAT(complaint("[a]\ndriver = CHokuyoURG\n", "a"), HasSubstr("EngramGigECamera"));
  EXPECT_THAT(complaint("[a]\nodometry = wheels\n", "a"), HasSubstr("no section [wheels]"));
  EXPECT_THAT(complaint("[a]\ncamera = L\nright_camera = L\n", "a"),
              HasSubstr("robot.ini: [a] right_camera: 'L' is the left camera too"));
  base::IniFile pair = base::IniFile::parse("[a]\ncamera = L\nright_camera = R\n", "robot.ini");
  EXPECT_EQ(takeLiveConfig(pair, "a").camera.right_camera, "R");
  base::IniFile empty = base::IniFile::parse("", "");
  EXPECT_EQ(takeLiveConfig(empty, "camera", true).camera.camera, "");
}

class SensorReaderTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { loadSensorPlugins({ENGRAM_ODOMETRY_PLUGIN}); }

  static base::IniFile::Section section(const std::string& more = "") {
    auto ini = base::IniFile::parse(
        "[w]\ndriver = CircleOdometry\nprocess_rate = 200\nsensorLabel = WHEELS\n" + more, "t");
    return *ini.take("w");
  }
};

TEST_F(SensorReaderTest, DeliversWhatAnMrptSensorObserves) {
  std::mutex mutex;
  std::vector<SensorReader::Object> objects;
  SensorReader reader("w", section("speed = 2\nturn = 0.5\n"), [&](const SensorReader::Object& object) {
    const std::lock_guard lock(mutex);
    objects.push_back(object);
  });
  const auto end = std::chrono::steady_clock::now() + 5s;
  while (reader.objects() < 20 && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(5ms);
  reader.stop();
  ASSERT_GE(objects.size(), 20u);
  for (const auto& object : objects) {
    const auto odometry = std::dynamic_pointer_cast<mrpt::obs::CObservationOdometry>(object);
    ASSERT_TRUE(odometry);
    EXPECT_EQ(odometry->sensorLabel, "WHEELS");
    const auto& pose = odometry->odometry;
    EXPECT_NEAR(std::hypot(pose.x(), pose.y() - 4.0), 4.0, 1e-9);  // the circle of radius speed / turn
  }
  EXPECT_EQ(reader.failure(), "");
}

TEST_F(SensorReaderTest, ReportsASensorThatFails) {
  SensorReader reader("w", section("fail_after = 3\n"), [](const SensorReader::Object&) {});
  const auto end = std::chrono::steady_clock::now() + 5s;
  while (reader.failure().empty() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(5ms);
  EXPECT_THAT(reader.failure(), HasSubstr("[w] the sensor has failed: the cable is out"));
  EXPECT_EQ(reader.objects(), 3u);
}

TEST_F(SensorReaderTest, SaysWhyASensorDoesNotStart) {
  const auto sink = [](const SensorReader::Object&) {};
  auto unknown = section();
  unknown["driver"].text = "CNoSuchSensor";
  EXPECT_THAT(messageOf([&] { SensorReader("w", unknown, sink); }), HasSubstr("[w] driver = CNoSuchSensor"));
  unknown.erase("driver");
  EXPECT_THAT(messageOf([&] { SensorReader("w", unknown, sink); }), HasSubstr("driver is missing"));
  EXPECT_THAT(messageOf([&] { SensorReader("w", section("turn = 0\n"), sink); }),
              HasSubstr("turn must not be zero"));
  EXPECT_THAT(messageOf([&] { loadSensorPlugins({"/nowhere/x.so"}); }), HasSubstr("no such file"));
  EXPECT_THAT(messageOf([&] { loadSensorPlugins({ENGRAM_SOURCE_DIR "/README.md"}); }),
              HasSubstr("cannot be loaded"));
}

}  // namespace
}  // namespace engram::capture
