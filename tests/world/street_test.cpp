// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tiny_world.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <map>
#include <set>

namespace engram::world {
namespace {

/// One street of 20 x 6 m between houses 8 m high; its floor is x 1 … 21, y 1 … 7.
const World& street() {
  static const World world = [] {
    std::string text = "name street\ncell 0.5\nheight 8\nroof none\nroute 3,3 19,3 19,5 3,5\ngrid\n";
    const std::string wall(44, '#'), free = "##" + std::string(40, '.') + "##";
    text += wall + "\n" + wall + "\n";
    for (int y = 0; y < 12; ++y) text += free + "\n";
    text += wall + "\n" + wall + "\nend\n";
    WorldParams params;
    params.change.people = 0;
    return World(parsePlan(text, "street"), params);
  }();
  return world;
}

Appearance bareAt(double hour) {
  Schedule schedule(street().building(), street().params().change);
  Appearance day = schedule.session(1);
  day.furniture.clear();
  day.cloud = 0.8;  // the sun would make it another test
  return schedule.atHour(day, hour);
}

// A ray meets a house below its roof, and the sky above it.
TEST(Street, SeesTheSkyOverTheHouses) {
  const Appearance noon = bareAt(12);
  const Scene scene(street().building(), noon, street().library());
  const Eigen::Array3f o(3.3f, 3.0f, 1.0f);  // 4 m from the north wall
  EXPECT_EQ(scene.trace(o, {0, 0, 1}).kind, Hit::Kind::kOutside);
  EXPECT_EQ(scene.trace(o, {0, 0, -1}).kind, Hit::Kind::kFloor);
  for (int k = 0; k < 40; ++k) {
    const float slope = 0.1f * static_cast<float>(k);
    const Hit hit = scene.trace(o, {0, 1, slope});
    const float z = 1.0f + 4.0f * slope;  // where it reaches the wall
    EXPECT_EQ(hit.kind, z < 8 ? Hit::Kind::kWall : Hit::Kind::kOutside) << slope;
    if (z < 8) {
      EXPECT_NEAR(hit.t, 4.0f, 1e-3f);
    }
  }
}

// Between long walls of height h, the share of the sky's light that reaches a point on the ground at
// distances a and b from them is (sin A + sin B) / 2, with A, B the angles to which the sky opens (a slot
// between infinite walls; the ends are far).
TEST(Street, IsLitByTheOpenSky) {
  const Appearance noon = bareAt(12);
  const Scene scene(street().building(), noon, street().library());
  const auto light = [&](float x, float y, float z, int normal) {
    return scene.irradiance({x, y, z}, normal)[1];
  };
  const float sky = noon.daylight[1] * 0.45f;
  const float onRoof = light(11, 4, 7.9f, 4);  // the whole sky, at the height of the roofs
  EXPECT_NEAR(onRoof / sky, 1.0f, 0.35f);      // and what the walls give back
  const float ground = light(11, 4, 0, 4);
  const float depth = 8.0f - 8.0f / 6;  // light is known at the middle of the lowest level but one half
  const float slot = 3.0f / std::hypot(3.0f, depth);
  EXPECT_GT(ground / sky, 0.7f * slot);
  EXPECT_LT(ground, onRoof);
  EXPECT_GT(light(11, 1.1f, 7.0f, 2), light(11, 1.1f, 0.5f, 2));  // a front is brighter above
  // At night the lamps over the street are all the light there is.
  const Appearance night = bareAt(23);
  const Scene dark(street().building(), night, street().library());
  EXPECT_LT(dark.irradiance({11, 4, 0}, 4)[1], ground);
  EXPECT_GT(std::count(night.lampOn.begin(), night.lampOn.end(), true), 0);
  EXPECT_EQ(std::count(noon.lampOn.begin(), noon.lampOn.end(), true), 0);
}

// Along a front the houses follow each other, each with an entrance of its own; some fronts differ.
TEST(Street, HousesHaveFrontsOfTheirOwn) {
  const Building& b = street().building();
  std::map<std::uint32_t, int> width;  // cells, of the houses in the north
  std::set<int> looks;
  for (int x = 2; x < 42; ++x) {
    const std::uint32_t house = b.houseAt(b.cellAt(static_cast<float>(x) * 0.5f + 0.1f, 6.9f), 2);
    ++width[house];
    looks.insert(static_cast<int>(house % street().library().facades.size()));
  }
  EXPECT_EQ(width.size(), 3u);  // 21 m from x = 0, of 7 m each
  EXPECT_GE(looks.size(), 2u);
  for (const auto& [house, cells] : width) EXPECT_GE(cells, 12);
  int entrances = 0;
  for (const auto& f : b.fixtures()) entrances += f.kind == Fixture::kEntrance;
  EXPECT_GE(entrances, 6);  // three in the north, three in the south
  EXPECT_TRUE(b.doors().empty());
}

TEST(Street, PicturesAreWellExposedByDayAndNight) {
  const World campus = World::preset("campus", {});
  for (const int n : {1, 3}) {
    const cv::Mat image =
        renderAt(campus, campus.appearance(n), smallEyes("pinhole").left, campus.route().at(10.0));
    cv::Mat grey;
    cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    cv::Scalar mean, spread;
    cv::meanStdDev(grey, mean, spread);
    EXPECT_GT(mean[0], 35) << n;
    EXPECT_LT(mean[0], 215) << n;
    EXPECT_GT(spread[0], 12) << n;
  }
}

// Buildings with a roof have nothing of streets, so that their pictures stay as they were.
TEST(Street, BuildingsWithARoofStayAsTheyAre) {
  const World& w = tinyWorld();
  EXPECT_FALSE(w.plan().open);
  EXPECT_TRUE(w.library().facades.empty());
  EXPECT_TRUE(w.library().streets.empty());
  EXPECT_EQ(w.plan().toText().find("roof"), std::string::npos);
}

}  // namespace
}  // namespace engram::world
