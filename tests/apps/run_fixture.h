// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/frame.h"
#include "program_run.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace engram::apps {

RunResult slam(const std::vector<std::string>& arguments);
RunResult localize(const std::vector<std::string>& arguments);

/// A fresh folder for each test, beside drives and a map that all share and none may change.
class RunTest : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;
  std::string path(const std::string& name) const { return folder_ + "/" + name; }

  /// Rawlogs and truth (TUM) of two drives through the tiny building; the map of the first, made with its
  /// truth.
  static std::string rawlog(int drive);
  static std::string truth(int drive);
  static std::string firstMap();
  /// A copy that may be changed.
  std::string mapCopy() const;

  static std::string config() { return ENGRAM_SOURCE_DIR "/config/fsh_omni.ini"; }
  /// The configuration with one more line at its end.
  std::string configWith(const std::string& name, const std::string& text) const;

  std::string folder_;
};

void writeRawlog(const std::string& path, const std::vector<types::Frame>& frames);
/// The first `n` frames of the first drive.
std::vector<types::Frame> firstFrames(std::size_t n);

std::string bytesOf(const std::string& path);
void writeBytes(const std::string& path, const std::string& bytes);
nlohmann::json jsonOf(const std::string& path);
/// How many images the map holds records of; the map must be sound.
std::size_t soundImages(const std::string& map);

}  // namespace engram::apps
