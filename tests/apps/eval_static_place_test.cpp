// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/static_place.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <unistd.h>

namespace engram::apps {
namespace {
namespace fs = std::filesystem;

/// A room of 3 x 2 m with one window cell of 0.5 m, a wall, and a room without a window beside it.
world::Plan twoRooms() {
  return world::parsePlan(
      "name two\ncell 0.5\nheight 2.7\nroute 1,1 2.75,1 2.75,2 1,2\ngrid\n"
      "##=############\n"
      "#aaaaaa#bbbbbb#\n"
      "#aaaaaa#bbbbbb#\n"
      "#aaaaaa+bbbbbb#\n"
      "#aaaaaa+bbbbbb#\n"
      "###############\n"
      "end\n",
      "two rooms");
}

TEST(WindowExposure, IsTheInverseSquareOfWhatIsInSight) {
  const world::Plan plan = twoRooms();
  // The centre of the window is at (1.25, 2.75).
  EXPECT_NEAR(windowExposure(plan, 1.25, 0.75), 1 / 4.0, 1e-9);
  EXPECT_NEAR(windowExposure(plan, 2.25, 1.75), 1 / 2.0, 1e-9);
  EXPECT_EQ(windowExposure(plan, 5.25, 1.25), 0);  // behind the wall
  world::Plan blind = plan;
  for (char& c : blind.cells)
    if (c == '=') c = '#';
  EXPECT_EQ(windowExposure(blind, 1.25, 0.75), 0);
}

class StaticPlaceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "engram_place_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    params_.days = 2;
    params_.images = 4;
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::vector<StaticPlaceResult> run(const std::string& folder, int threads) const {
    fs::create_directories(folder_ + "/" + folder);
    return staticPlace(params_, "tiny", pipeline_, {folder_ + "/" + folder, 3, threads, nullptr});
  }

  std::string folder_;
  StaticPlaceParams params_;
  pipeline::PipelineParams pipeline_;
};

TEST_F(StaticPlaceTest, ComparesMemoriesAtTwoPlaces) {
  const auto results = run("a", 2);
  ASSERT_EQ(results.size(), 6u);
  std::map<std::string, double> exposure;
  const world::Plan plan = world::presetPlan("tiny", 3);
  for (const auto& r : results) {
    EXPECT_EQ(r.similarities.size(), 7u);
    double sum = 0;
    for (const double s : r.similarities) {
      EXPECT_GE(s, 0);
      EXPECT_LE(s, 1);
      sum += s / 7;
    }
    EXPECT_NEAR(r.mean.value, sum, 1e-12);
    EXPECT_EQ(r.mean.blocks, 2);
    exposure[r.place] = windowExposure(plan, r.T_world_robot.x, r.T_world_robot.y);
  }
  ASSERT_EQ(exposure.size(), 2u);
  EXPECT_GT(exposure["window"], 4 * exposure["inside"]);
  // One thread, and a second run that finds the days of the first, give the same to the last digit.
  const auto one = tableOf(run("b", 1)).toJson().dump();
  EXPECT_EQ(tableOf(results).toJson().dump(), one);
  fs::remove(folder_ + "/b/static_place/inside_day_2.features");
  const auto kept = fs::last_write_time(folder_ + "/b/static_place/window_day_1.features");
  EXPECT_EQ(tableOf(run("b", 2)).toJson().dump(), one);
  EXPECT_EQ(fs::last_write_time(folder_ + "/b/static_place/window_day_1.features"), kept);
}

// Nothing moves and nothing changes but the noise: the place looks as it did, to every memory.
TEST_F(StaticPlaceTest, NearlyTheSamePictureIsNearlyWhollyMatched) {
  params_.jitter = params_.jitter_heading = 0;
  params_.people = 0;
  params_.poster_share = params_.furniture_share = 0;
  params_.days = 1;
  params_.images = 10;
  const auto results = run("a", 2);
  for (const auto& r : results) {
    EXPECT_EQ(r.learnt, 9) << r.place << " " << r.method;
    EXPECT_GT(r.similarities.front(), 0.75) << r.place << " " << r.method;  // 8:42 and 10:06
  }
}

}  // namespace
}  // namespace engram::apps
