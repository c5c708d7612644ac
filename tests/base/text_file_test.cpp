// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/text_file.h"

#include "engram/base/config.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace engram::base {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;
namespace fs = std::filesystem;

const std::string kMark = "\xEF\xBB\xBF";

class TextFile : public ::testing::Test {
 protected:
  TextFile() {
    std::string name = (fs::temp_directory_path() / "engram_text_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~TextFile() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  std::string write(const std::string& text) const {
    std::ofstream(folder_ + "/f.ini", std::ios::binary) << text;
    return folder_ + "/f.ini";
  }
  std::string folder_;
};

TEST_F(TextFile, IsTheSameTextHoweverItWasWritten) {
  const std::string truth = "a\n\nb c\n";
  for (const std::string& mark : {std::string(), kMark})
    for (const std::string end : {"\n", "\r\n", "\r"})
      for (const std::string& last : {std::string(), end})
        EXPECT_EQ(readTextFile(write(mark + "a" + end + end + "b c" + last)), truth)
            << mark.size() << ' ' << end.size() << ' ' << last.size();
  EXPECT_EQ(readTextFile(write("")), "");
  EXPECT_EQ(readTextFile(write(kMark)), "");
  EXPECT_EQ(plainText("a\r\r\n\nb", "t"), "a\n\n\nb\n");
  EXPECT_EQ(plainText("a" + kMark + "b\n", "t"), "a" + kMark + "b\n") << "a mark elsewhere is a character";
}

TEST_F(TextFile, LongTextsAreReadWhole) {
  std::string text;
  for (int i = 0; i < 40000; ++i) text += std::to_string(i) + "\r\n";  // some blocks end between CR and LF
  std::string truth;
  for (int i = 0; i < 40000; ++i) truth += std::to_string(i) + "\n";
  EXPECT_EQ(readTextFile(write(text)), truth);
}

TEST_F(TextFile, WhatIsNoTextIsRefusedByName) {
  const auto refuses = [](const std::string& path, const std::string& message) {
    EXPECT_THAT([&] { readTextFile(path); },
                ThrowsMessage<Error>(::testing::AllOf(StartsWith(path), HasSubstr(message))));
  };
  refuses(folder_, "is a folder");
  refuses(folder_ + "/none", "cannot be opened");
  refuses(write(std::string("\xFF\xFE[\0a\0", 6)), "UTF-16");
  refuses(write(std::string("a = 1\0\n", 7)), "is no text");
}

struct OneKey {
  double value = 7;
  void describe(Params& p) { p.add("value", value, "a number"); }
};

double valueOf(const std::string& path) {
  OneKey params;
  Config config;
  config.bind("one", params);
  config.read(IniFile::load(path));
  return params.value;
}

TEST_F(TextFile, AConfigurationIsNeverReadAsDefaultsInSilence) {
  EXPECT_EQ(valueOf(write("# old Mac\r[one]\rvalue = 3\r")), 3);
  EXPECT_EQ(valueOf(write(kMark + "[one]\r\nvalue = 3")), 3);
  EXPECT_EQ(valueOf(write(kMark + "; first\n[one]\nvalue = 3\n")), 3);
  EXPECT_THAT([&] { valueOf(folder_); }, ThrowsMessage<ConfigError>(HasSubstr("is a folder")));
}

TEST_F(TextFile, LinesAreNumberedWithAnyLineEnd) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const std::string path = write("# c" + end + "[one]" + end + end + "vlaue = 3" + end);
    EXPECT_THAT([&] { valueOf(path); }, ThrowsMessage<ConfigError>(HasSubstr("f.ini:4: [one] vlaue")));
  }
}

}  // namespace
}  // namespace engram::base
