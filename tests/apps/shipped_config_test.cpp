// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/shipped_config.h"

#include "engram/base/error.h"
#include "engram/base/text_file.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace engram::apps {
namespace {

std::map<std::string, std::string> valuesOf(const base::IniFile& ini) {
  std::map<std::string, std::string> values;
  for (const auto& [section, keys] : ini.sections())
    for (const auto& [key, value] : keys) values[section + "." + key] = value.text;
  return values;
}

TEST(ShippedConfig, IsEveryFileOfTheFolder) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(ENGRAM_SOURCE_DIR "/config")) {
    const std::string name = entry.path().filename().string();
    EXPECT_EQ(valuesOf(shippedConfig(name)),
              valuesOf(base::IniFile::parse(base::readTextFile(entry.path().string()), name)))
        << name;
    ++files;
  }
  EXPECT_GE(files, 8);
  EXPECT_THROW(shippedConfig("fsh_none.ini"), base::Error);
}

}  // namespace
}  // namespace engram::apps
