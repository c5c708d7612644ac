// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/config_file.h"

#include "engram/base/atomic_file.h"
#include "engram/base/error.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <unistd.h>

namespace engram::apps {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class ConfigFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("engram_config_file_" + std::to_string(::getpid()));
    fs::create_directories(folder_ / "engram");
    ::setenv("XDG_CONFIG_HOME", folder_.c_str(), 1);
    write("engram/robot.ini", "[camera]\nfile = eyes/left.ini\n");
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) const {
    base::writeText((folder_ / name).string(), text, true);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string cameraOf(const std::string& given) const {
    return loadConfig(given).sections().at("camera").at("file").text;
  }

  fs::path folder_;
};

TEST_F(ConfigFile, IsFoundByName) {
  EXPECT_EQ(findConfig("robot"), path("engram/robot.ini"));
  EXPECT_EQ(findConfig("robot.ini"), path("engram/robot.ini"));
  EXPECT_THAT(configNames(), Contains("robot"));
}

TEST_F(ConfigFile, IsAPathWhenThereIsSuchAFile) {
  write("own.ini", "[camera]\nfile = /there.ini\n");
  EXPECT_EQ(findConfig(path("own.ini")), path("own.ini"));
  EXPECT_EQ(cameraOf(path("own.ini")), "/there.ini");
}

TEST_F(ConfigFile, NamesItsCameraRelativeToItselfThroughLinksToo) {
  const std::string camera = fs::weakly_canonical(folder_ / "engram/eyes/left.ini").string();
  EXPECT_EQ(cameraOf("robot"), camera);
  fs::create_directory(folder_ / "elsewhere");
  fs::create_symlink(folder_ / "engram/robot.ini", folder_ / "elsewhere/link.ini");
  EXPECT_EQ(cameraOf(path("elsewhere/link.ini")), camera);
  EXPECT_EQ(loadConfig("robot").sections().at("camera").at("file").origin, path("engram/robot.ini") + ":2");
}

TEST_F(ConfigFile, MissesAreExplained) {
  EXPECT_THAT([&] { findConfig("robt"); }, ThrowsMessage<base::ConfigError>(AllOf(
                                               HasSubstr("no such configuration"), HasSubstr("robot"))));
  EXPECT_THAT([&] { findConfig(path("engram")); },
              ThrowsMessage<base::ConfigError>(HasSubstr("is a folder, not a configuration")));
}

}  // namespace
}  // namespace engram::apps
