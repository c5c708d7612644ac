// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/json_file.h"

#include "engram/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace engram::apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class JsonFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/engram_json_XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string file(const std::string& text) const {
    const std::string path = (folder_ / "run.json").string();
    std::ofstream(path) << text;
    return path;
  }
  std::filesystem::path folder_;
};

TEST_F(JsonFileTest, IsReadOrRefused) {
  EXPECT_EQ(readJson(file(R"({"a": [1, "[[[["]})")).at("a").at(0), 1);
  EXPECT_THROW(readJson(file("{")), nlohmann::json::exception);
  EXPECT_TRUE(readJsonIfAny(file("{")).is_discarded());
  EXPECT_TRUE(readJsonIfAny((folder_ / "none").string()).is_discarded());
}

/// The parser takes it; to copy or free it ends at the end of the stack.
TEST_F(JsonFileTest, IsRefusedWhenItIsNestedWithoutEnd) {
  const std::string path = file(std::string(200000, '[') + std::string(200000, ']'));
  const auto refused = ThrowsMessage<base::Error>(AllOf(HasSubstr(path), HasSubstr("more than 64 deep")));
  EXPECT_THAT([&] { readJson(path); }, refused);
  EXPECT_THAT([&] { readJsonIfAny(path); }, refused);
  EXPECT_NO_THROW(readJson(file(std::string(64, '[') + std::string(64, ']'))));
}

TEST_F(JsonFileTest, IsWrittenWhateverBytesANameHas) {
  EXPECT_EQ(toText(nlohmann::json{{"name", "a\xff"}}), "{\"name\":\"a\uFFFD\"}");
}

}  // namespace
}  // namespace engram::apps
