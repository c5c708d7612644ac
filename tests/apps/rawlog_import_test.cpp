// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// engram-rawlog import and info on bags that other writers made (tests/fixtures/bags).
#include "engram/sources/rawlog_source.h"
#include "program_run.h"
#include "rawlog_program.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace engram::apps {
namespace {

using ::testing::HasSubstr;

RunResult runRawlog(const std::vector<std::string>& arguments) { return runAs<RawlogProgram>(arguments); }

std::string bagOfWriter(const std::string& name) {
  return std::string(ENGRAM_SOURCE_DIR) + "/tests/fixtures/bags/" + name;
}

class RawlogImport : public testing::Test {
 protected:
  RawlogImport() {
    std::string name = (std::filesystem::temp_directory_path() / "engram_import_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~RawlogImport() override { std::filesystem::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::filesystem::path folder_;
};

TEST_F(RawlogImport, MakesACalibratedRawlogWithOdometry) {
  const auto result =
      runRawlog({"import", bagOfWriter("ros2_zstd.mcap"), "--image", "/stereo/left/image_raw", "--right",
                 "/stereo/right/image_raw", "--out", path("walk.rawlog"), "--json", path("walk.json"), "-q"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("3 images, 3 with odometry"));
  EXPECT_THAT(result.out, HasSubstr("mount: left_optical on base_link"));
  EXPECT_THAT(result.out, HasSubstr("2 images of one eye without the other"));
  const auto json = nlohmann::json::parse(std::ifstream(path("walk.json")));
  EXPECT_EQ(json["stereo_calibration"], true);
  const auto rawlog = sources::openRawlog(path("walk.rawlog"), {});
  const auto frame = rawlog->next();
  ASSERT_TRUE(frame && frame->T_odom_robot && !frame->right.empty());
  EXPECT_NEAR(frame->stamp, 1700000000, 1e-6);
  ASSERT_TRUE(rawlog->calibration());
  EXPECT_NEAR(rawlog->calibration()->T_left_right().translation().x(), 0.12, 1e-6);
  EXPECT_NEAR(rawlog->calibration()->left.T_robot_cam.translation().z(), 0.6, 1e-6);
}

TEST_F(RawlogImport, ListsTheTopicsOfABag) {
  const auto result = runRawlog({"info", bagOfWriter("ros1_lz4.bag"), "-q"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("/stereo/left/image_raw (sensor_msgs/Image): 4\n"));
  EXPECT_THAT(result.out, HasSubstr("/odom (nav_msgs/Odometry): 5\n"));
}

TEST_F(RawlogImport, AsksForTheCamera) {
  const auto result = runRawlog({"import", bagOfWriter("ros2.db3"), "--out", path("walk.rawlog"), "-q"});
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.err, HasSubstr("Name its topic with --image"));
  EXPECT_FALSE(std::filesystem::exists(path("walk.rawlog")));
}

TEST_F(RawlogImport, OfHalfABagIsPartial) {
  std::ifstream in(bagOfWriter("ros2_none.mcap"), std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  std::ofstream(path("half.mcap"), std::ios::binary) << whole.substr(0, whole.size() / 2);
  const auto result = runRawlog(
      {"import", path("half.mcap"), "--image", "/stereo/left/image_raw", "--out", path("half.rawlog"), "-q"});
  EXPECT_EQ(result.code, 3);
  EXPECT_THAT(result.err, HasSubstr("what came before was read"));
  EXPECT_TRUE(std::filesystem::exists(path("half.rawlog")));
}

}  // namespace
}  // namespace engram::apps
