// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// Bags that other writers made (tests/fixtures/bags), whole and damaged.
#include "engram/bags/bag.h"

#include "engram/bags/bag_source.h"
#include "engram/base/error.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <unistd.h>

namespace engram::bags {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::string fixture(const std::string& name) {
  return std::string(ENGRAM_SOURCE_DIR) + "/tests/fixtures/bags/" + name;
}

std::string contentOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class BagInFolder : public testing::Test {
 protected:
  BagInFolder() {
    std::string name = (fs::temp_directory_path() / "engram_bag_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~BagInFolder() override { fs::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return (folder_ / name).string();
  }

  fs::path folder_;
};

class BagTest : public BagInFolder, public testing::WithParamInterface<const char*> {};

TEST_P(BagTest, HoldsTheTopicsThatItsWriterGave) {
  ASSERT_TRUE(isBag(fixture(GetParam())));
  const auto bag = openBag(fixture(GetParam()));
  std::int64_t last = 0;
  while (const auto message = bag->next()) {
    EXPECT_GE(message->received + 100'000'000, last);
    last = message->received;
  }
  EXPECT_EQ(bag->problem(), "");
  std::map<std::string, std::pair<std::string, std::size_t>> topics;
  for (const auto& topic : bag->topics()) topics[topic.name] = {topic.type, topic.messages};
  const std::map<std::string, std::pair<std::string, std::size_t>> expected{
      {"/tf_static", {"tf2_msgs/TFMessage", 1}},
      {"/odom", {"nav_msgs/Odometry", 5}},
      {"/stereo/left/camera_info", {"sensor_msgs/CameraInfo", 4}},
      {"/stereo/right/camera_info", {"sensor_msgs/CameraInfo", 4}},
      {"/stereo/left/image_raw", {"sensor_msgs/Image", 4}},
      {"/stereo/right/image_raw", {"sensor_msgs/Image", 4}},
      {"/top/image_raw/compressed", {"sensor_msgs/CompressedImage", 4}}};
  EXPECT_EQ(topics, expected);
}

TEST_P(BagTest, GivesWhatComesBeforeItsEnd) {
  const std::string whole = contentOf(fixture(GetParam()));
  for (int part = 0; part < 40; ++part) {
    const auto length = whole.size() * static_cast<std::size_t>(part) / 40;
    const std::string path = write("cut", whole.substr(0, length));
    std::size_t messages = 0;
    std::string problem;
    try {
      const auto bag = openBag(path);
      while (bag->next()) ++messages;
      problem = bag->problem();
    } catch (const base::Error& e) {
      problem = e.what();
    }
    EXPECT_LE(messages, 26u);
    EXPECT_THAT(messages < 26 ? problem : path, HasSubstr(path)) << length;
  }
}

TEST_P(BagTest, WithWrongBytesIsReadOrRefused) {
  const std::string whole = contentOf(fixture(GetParam()));
  BagSourceParams params;
  params.image = "/stereo/left/image_raw";
  for (std::size_t at = 16; at < whole.size(); at += whole.size() / 200 + 1) {
    std::string wrong = whole;
    wrong[at] = static_cast<char>(wrong[at] ^ 0x5A);
    const std::string path = write("wrong", wrong);
    try {
      const auto source = openBagSource(path, params);
      while (source->next()) continue;
    } catch (const base::Error&) {
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Writers, BagTest,
                         testing::Values("ros1_none.bag", "ros1_bz2.bag", "ros1_lz4.bag", "ros2.db3",
                                         "ros2_none.mcap", "ros2_lz4.mcap", "ros2_zstd.mcap"));

TEST_F(BagInFolder, OfSeveralFilesIsOneFolder) {
  fs::copy_file(fixture("ros2.db3"), folder_ / "walk_2.db3");
  fs::copy_file(fixture("ros2.db3"), folder_ / "walk_10.db3");
  ASSERT_TRUE(isBag(folder_.string()));
  const auto bag = openBag(folder_.string());
  std::size_t messages = 0;
  while (bag->next()) ++messages;
  EXPECT_EQ(bag->problem(), "");
  EXPECT_EQ(messages, 52u);
  EXPECT_EQ(bag->topics().size(), 7u);
  EXPECT_DOUBLE_EQ(bag->progress(), 1.0);
}

TEST_F(BagInFolder, ThatStatesTooMuchTakesNoMemory) {
  // A chunk of 4 GB by its header, without content.
  const auto number = [](std::uint32_t n) { return std::string(reinterpret_cast<const char*>(&n), 4); };
  const auto field = [&](const std::string& text) {
    return number(static_cast<std::uint32_t>(text.size())) + text;
  };
  const std::string header =
      field(std::string("op=\x05")) + field("compression=bz2") + field("size=" + number(0xFFFFFFFF));
  const auto bag = openBag(write("huge.bag", "#ROSBAG V2.0\n" + field(header) + number(0)));
  EXPECT_FALSE(bag->next());
  EXPECT_THAT(bag->problem(), HasSubstr("4294967295 bytes, too many"));
}

TEST_F(BagInFolder, IsToldFromOtherFiles) {
  EXPECT_FALSE(isBag(write("walk.bag", "rawlog")));
  EXPECT_FALSE(isBag((folder_ / "none").string()));
  try {
    openBag(write("walk.db3.zstd", "(zstd"));
    FAIL();
  } catch (const base::Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("zstd -d"));
  }
}

}  // namespace
}  // namespace engram::bags
