// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/line_file.h"

#include "engram/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <unistd.h>

namespace engram::base::line_file {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string bytesOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class LineFileTest : public ::testing::Test {
 protected:
  LineFileTest() {
    std::string name = (fs::temp_directory_path() / "engram_lines_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~LineFileTest() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  fs::path folder_;
};

TEST_F(LineFileTest, EveryLineIsThereAtOnce) {
  LineFile file(path("a.csv"));
  file.add("one");
  EXPECT_EQ(bytesOf(path("a.csv")), "one\n");
  file.add("two");
  EXPECT_EQ(bytesOf(path("a.csv")), "one\ntwo\n");
  EXPECT_THAT(file.failure(), IsEmpty());
}

TEST_F(LineFileTest, AnOldFileStaysUntilTheFirstLine) {
  std::ofstream(path("a.csv")) << "old";
  LineFile file(path("a.csv"));
  EXPECT_EQ(bytesOf(path("a.csv")), "old");
  file.add("new");
  EXPECT_EQ(bytesOf(path("a.csv")), "new\n");
}

TEST_F(LineFileTest, AnEmptyPathWritesNothing) {
  LineFile file("");
  EXPECT_FALSE(file.wanted());
  file.add("one");
  EXPECT_THAT(file.failure(), IsEmpty());
}

TEST_F(LineFileTest, AFileThatCannotBeBegunIsAnError) {
  LineFile file(folder_.string());
  try {
    file.add("one");
    FAIL() << "a folder was written";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("it is a folder"));
  }
}

// /dev/full takes no byte, as a full disk does.
TEST_F(LineFileTest, AFullDiskIsSaidAndDoesNotThrow) {
  LineFile file("/dev/full");
  file.add("one");
  EXPECT_THAT(file.failure(), HasSubstr("'/dev/full' lacks lines: No space left on device"));
  file.add("two");
  EXPECT_THAT(file.failure(), HasSubstr("No space left on device"));
}

}  // namespace
}  // namespace engram::base::line_file
