// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/error.h"
#include "engram/store/map_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <unistd.h>

namespace engram::store {

/// A fresh folder for each test.
class StoreTest : public ::testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/engram_store_XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    folder_ = name;
  }
  void TearDown() override {
    std::filesystem::permissions(folder_, std::filesystem::perms::owner_all,
                                 std::filesystem::perm_options::add);
    std::filesystem::remove_all(folder_);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::filesystem::path folder_;
};

inline map::MapHeader sampleHeader() {
  map::MapHeader h;
  h.engramVersion = "0.1.0";
  h.camera = "model = unified_sphere\nxi = 0.95\nwidth = 640\n";
  h.extractor = "surf";
  h.descriptorDim = 64;
  h.memoryModel = "fsh";
  h.parameters = "[memory]\nltm_threshold = 0.7\n";
  h.firstStamp = 1234567890.123456789;
  return h;
}

inline types::FrameReport sampleReport() {
  types::FrameReport r;
  r.index = 42;
  r.stamp = 1700000000.25;
  r.label = "img_\"042\".png";
  r.outcome = types::Outcome::kRecognised;
  r.reason = "too few inliers: 11 of 30";
  r.features = 512;
  r.place = base::PlaceId(3);
  r.bestGuess = base::PlaceId(4);
  r.bestGuessInterpolated = 3.4;
  r.newPlaceProbability = 0.1;
  r.pose.emplace().place = base::PlaceId(3);
  r.pose->T_map_robot =
      Eigen::Translation3d(1.5, -2.25, 0) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ());
  r.pose->T_place_robot.cov.diagonal() << 0.04 * 0.04, 0.03 * 0.03, 1, 1, 1, 0.02 * 0.02;
  r.hypotheses = {{base::PlaceId(3), 0.8, 0.7, 120}, {base::PlaceId(4), 0.3, 0.1, -1}};
  r.closure = true;
  r.closuresDropped = 1;
  r.closuresRestored = 2;
  r.learnt = {base::PlaceId(3), base::PlaceId(9)};
  r.memory = {1, 2, 3, 4, 5, 6, 7};
  r.times = {{"perceive", 5.5}, {"recognise", 1.25}};
  r.milliseconds = 8.5;
  return r;
}

inline std::string text(const map::MapHeader& header, const map::MapContent& content,
                        const std::vector<types::FrameReport>& records = {}) {
  std::ostringstream out;
  dump(out, header, content, records);
  return out.str();
}

inline std::string fileBytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void writeBytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// The message of the base::Error that f() throws.
template <class F>
std::string messageOf(F&& f) {
  try {
    f();
  } catch (const base::Error& e) {
    return e.what();
  }
  return "no base::Error";
}

}  // namespace engram::store
