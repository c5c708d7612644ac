// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tiny_world.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <numbers>

namespace engram::world {
namespace {

bool sameBytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::norm(a, b, cv::NORM_L1) == 0;
}

double meanDifference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total() * 3);
}

TEST(Texture, MipmapsKeepTheMeanLight) {
  cv::Mat board(64, 64, CV_8UC3, cv::Scalar::all(0));
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      if ((x + y) % 2) board.at<cv::Vec3b>(y, x) = {255, 255, 255};
  const Texture t(board);
  EXPECT_NEAR(t.sample(0.3f, 0.7f, t.levels() - 1)[1], 0.5, 0.01);  // of the light; the byte is 180
  EXPECT_NEAR(t.sample(0.5f / 64, 0.5f / 64, 0)[0], 0, 1e-6);
  EXPECT_NEAR(t.sample(1.5f / 64, 0.5f / 64, 0)[0], 1, 1e-6);
  EXPECT_NEAR(t.sample(1 + 1.5f / 64, -63.5f / 64, 0)[0], 1, 1e-5);  // repeats
}

// Rays against the plan: the distance to a wall is the distance in the plan.
TEST(Scene, MeetsWallsWhereThePlanHasThem) {
  const World& w = tinyWorld();
  Appearance bare = w.appearance(1);
  bare.furniture.clear();
  const Scene scene(w.building(), bare, w.library());
  const Eigen::Array3f o(2.0f, 1.9f, 1.5f);  // in the south corridor: floor x 1 … 8.5, y 1 … 2.5
  const Hit west = scene.trace(o, Eigen::Array3f(-1, 0, 0)), down = scene.trace(o, Eigen::Array3f(0, 0, -1));
  EXPECT_EQ(west.kind, Hit::Kind::kWall);
  EXPECT_NEAR(west.t, 1.0, 1e-4);
  EXPECT_EQ(down.kind, Hit::Kind::kFloor);
  EXPECT_NEAR(down.t, 1.5, 1e-4);
  const Hit high = scene.trace({3.5f, 1.9f, 1.5f}, Eigen::Array3f(0, -1, 1.3f));  // above the window's head
  EXPECT_EQ(high.kind, Hit::Kind::kWall);
  EXPECT_NEAR(high.t, 0.9, 1e-4);
  const Hit out = scene.trace({3.3f, 1.9f, 1.5f}, Eigen::Array3f(0, -1, 0));  // through its pane
  EXPECT_EQ(out.kind, Hit::Kind::kOutside);
}

// A corner of the building projects where the picture shows it: the picture changes its surface there.
TEST(Renderer, ProjectionAgreesWithTheCameraModel) {
  const World& w = tinyWorld();
  Appearance bare = w.appearance(1);
  bare.furniture.clear();
  const Scene scene(w.building(), bare, w.library());
  for (const char* name : {"omni", "pinhole"}) {
    const Eyes eyes = presetEyes(name);
    const Eigen::Isometry3d T = types::toIsometry({2.2, 1.9, 2.7}) * eyes.left.T_robot_cam;
    int checked = 0;
    for (const double z : {0.3, 0.6, 1.0, 1.3, 1.6}) {
      const Eigen::Vector3d corner(1.0, 2.6,
                                   z);  // on the west wall, beyond the end of the south corridor's north side
      const auto pixel = eyes.left.camera->project(T.inverse() * corner);
      if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() >= 640 || pixel->y() >= 480) continue;
      const auto ray = eyes.left.camera->unproject(*pixel);
      ASSERT_TRUE(ray);
      const Eigen::Vector3d d = T.linear() * *ray;
      const Hit hit = scene.trace(T.translation().cast<float>().array(), d.cast<float>().array());
      const Eigen::Vector3d p = T.translation() + d * hit.t;
      EXPECT_NEAR((p - corner).norm(), 0, 2e-3) << name << " z " << z << " hit " << p.transpose();
      ++checked;
    }
    EXPECT_GE(checked, 2) << name;
  }
}

// The same in pixels: a white sheet on a dark wall is seen by the renderer exactly inside its projected
// outline.
TEST(Renderer, ShowsABoxWhereItProjects) {
  const World& w = tinyWorld();
  Appearance bare = w.appearance(1);
  bare.furniture.clear();
  Appearance with = bare;
  Furniture shelf;
  shelf.kind = FurnitureKind::kBookshelf;
  shelf.centre = {1.3f, 1.75f};
  shelf.facing = 0;
  with.furniture.push_back(shelf);
  const Scene a(w.building(), bare, w.library()), b(w.building(), with, w.library());
  const Eyes eyes = presetEyes("pinhole");
  const Eigen::Isometry3d T = types::toIsometry({4.0, 1.75, std::numbers::pi}) * eyes.left.T_robot_cam;
  const Eigen::Vector2f half = shelf.half();
  // Front face at x = centre + half, seen head on: a rectangle in the picture.
  const auto low = *eyes.left.camera->project(
      T.inverse() * Eigen::Vector3d(shelf.centre.x() + half.x(), shelf.centre.y() - half.y(), 0));
  const auto high = *eyes.left.camera->project(
      T.inverse() * Eigen::Vector3d(shelf.centre.x() + half.x(), shelf.centre.y() + half.y(), 2.0));
  int wrong = 0, total = 0;
  for (int y = 5; y < 475; y += 5)
    for (int x = 5; x < 635; x += 5) {
      const auto ray = *eyes.left.camera->unproject(Eigen::Vector2d(x, y));
      const Eigen::Vector3f d = (T.linear() * ray).cast<float>();
      const Eigen::Array3f o = T.translation().cast<float>().array();
      const float t0 = a.trace(o, d.array()).t, t1 = b.trace(o, d.array()).t;
      const bool inside = x > low.x() && x < high.x() && y < low.y() && y > high.y();
      total += inside;
      wrong += inside != (t1 < t0 - 0.01f);
    }
  EXPECT_GT(total, 300);
  EXPECT_LE(wrong, total / 20);  // the sides of the box peep out by a pixel or two
}

TEST(Renderer, SameSeedSameBytesWhateverTheThreads) {
  const World first = World::preset("tiny", {}), second = World::preset("tiny", {});
  const Session one(first, 2, smallEyes("omni"), DriveKind::kTour, 1),
      two(second, 2, smallEyes("omni"), DriveKind::kTour, 2);
  ASSERT_EQ(one.size(), two.size());
  for (const std::size_t i : {0u, 7u, 20u}) {
    EXPECT_TRUE(sameBytes(one.frame(i, 1).image, two.frame(i, 2).image)) << i;
    EXPECT_EQ(one.frame(i).T_odom_robot->matrix(), two.frame(i).T_odom_robot->matrix());
  }
  WorldParams other;
  other.seed = 2;
  const World third = World::preset("tiny", other);
  const Session three(third, 2, smallEyes("omni"));
  EXPECT_FALSE(sameBytes(one.frame(0).image, three.frame(0).image));
}

TEST(Renderer, PicturesAreWellExposedByDayAndNight) {
  for (int n = 1; n <= 4; ++n) {
    const Session session(tinyWorld(), n, smallEyes("pinhole"));
    for (std::size_t i = 0; i < session.size(); i += 6) {
      cv::Mat grey;
      cv::cvtColor(session.frame(i).image, grey, cv::COLOR_BGR2GRAY);
      cv::Scalar mean, spread;
      cv::meanStdDev(grey, mean, spread);
      EXPECT_GT(mean[0], 35) << n << " " << i << " " << session.appearance().inWords();
      EXPECT_LT(mean[0], 215) << n << " " << i << " " << session.appearance().inWords();
      EXPECT_GT(spread[0], 12) << n << " " << i;
    }
  }
}

// Noise off, one sample, no people: what does not change looks the same, what changes does not.
TEST(Session, LightChangesThePictureAndTheWallStays) {
  WorldParams p;
  p.sensor.noise = false;
  p.change.light = false;
  p.change.poster_share = 1;
  p.change.furniture_share = p.change.door_share = 0;
  const World w = World::preset("tiny", p);
  const Eyes eyes = smallEyes("pinhole");
  const Pose2 pose{4, 1.75, 0.3};
  const cv::Mat a = renderAt(w, w.appearance(1), eyes.left, pose),
                b = renderAt(w, w.appearance(2), eyes.left, pose);
  cv::Mat difference, grey;
  cv::absdiff(a, b, difference);
  cv::cvtColor(difference, grey, cv::COLOR_BGR2GRAY);
  const double changed = cv::countNonZero(grey > 12) / static_cast<double>(grey.total());
  EXPECT_GT(changed, 0.005);  // the posters
  EXPECT_LT(changed, 0.5);    // and nothing else
  p.change.light = true;
  p.change.poster_share = 0;
  const World lit = World::preset("tiny", p);
  EXPECT_GT(meanDifference(renderAt(lit, lit.appearance(1), eyes.left, pose),
                           renderAt(lit, lit.appearance(3), eyes.left, pose)),
            3);
}

// Someone close before the camera changes the picture there; no one leaves it as it is.
TEST(Session, PeopleStandInThePictureOfAPose) {
  const World& w = tinyWorld();
  const Eyes eyes = smallEyes("pinhole");
  const Appearance day = w.appearance(1);
  const Scene scene(w.building(), day, w.library());
  const Renderer renderer(eyes.left, w.params().sensor);
  const Pose2 robot{4, 1.75, 0};
  const Eigen::Isometry3d T = toIsometry(robot) * eyes.left.T_robot_cam;
  const cv::Mat plain = renderAt(w, day, eyes.left, robot);
  EXPECT_EQ(meanDifference(plain, renderAt(scene, renderer, T, {}, w.params().seed)), 0);
  Pillar person;
  person.centre = {5.2f, 1.75f};
  person.texture = w.library().people.front();
  EXPECT_GT(meanDifference(plain, renderAt(scene, renderer, T, {person}, w.params().seed)), 2);
  for (const Pillar& q : walkers(w, 20, 7, 30.0, robot))
    EXPECT_GE((q.centre.cast<double>() - Eigen::Vector2d(robot.x, robot.y)).norm(), 0.69);
}

TEST(Session, StereoPairHasTheDisparityOfItsDepth) {
  WorldParams p;
  p.sensor.noise = false;
  p.change.people = 0;
  const World w = World::preset("tiny", p);
  const Session session(w, 1, presetEyes("stereo"));
  const types::Frame f = session.frame(3);
  ASSERT_FALSE(f.right.empty());
  const Eigen::Isometry3d T_world_cam = session.T_world_robot(3) * session.eyes().left.T_robot_cam;
  cv::Mat left, right;
  cv::cvtColor(f.image, left, cv::COLOR_BGR2GRAY), cv::cvtColor(f.right, right, cv::COLOR_BGR2GRAY);
  int right1 = 0, total = 0;
  for (int y = 60; y < 420; y += 30)
    for (int x = 120; x < 600; x += 30) {
      const cv::Rect patch(x - 10, y - 10, 21, 21);
      cv::Scalar mean, spread;
      cv::meanStdDev(left(patch), mean, spread);
      if (spread[0] < 18) continue;
      const auto ray =
          *session.eyes().left.camera->unproject({static_cast<double>(x), static_cast<double>(y)});
      const Eigen::Vector3f d = (T_world_cam.linear() * ray).cast<float>();
      const Hit hit = session.scene().trace(T_world_cam.translation().cast<float>().array(), d.array());
      const double expected = 320 * 0.09 / (hit.t * ray.z());
      if (expected > 90 || hit.kind == Hit::Kind::kOutside) continue;
      cv::Mat score;
      cv::matchTemplate(right(cv::Rect(x - 110, y - 10, 121, 21)), left(patch), score, cv::TM_SQDIFF);
      cv::Point best;
      cv::minMaxLoc(score, nullptr, nullptr, &best);
      ++total;
      right1 += std::abs((100 - best.x) - expected) < 2;
    }
  ASSERT_GT(total, 30);
  EXPECT_GT(right1, total * 7 / 10) << total;
}

TEST(WorldSource, DeliversTheSession) {
  const auto session = std::make_shared<Session>(tinyWorld(), 1, smallEyes("omni"));
  EXPECT_LE(session->size(), 45u);
  WorldSource source(session);
  std::size_t n = 0;
  double last = 0;
  while (const auto f = source.next()) {
    EXPECT_EQ(f->index, n);
    EXPECT_GT(f->stamp, last);
    EXPECT_TRUE(f->T_odom_robot);
    last = f->stamp;
    ++n;
  }
  EXPECT_EQ(n, session->size());
  EXPECT_EQ(source.progress(), 1.0);
  EXPECT_TRUE(source.problem().empty());
}

}  // namespace
}  // namespace engram::world
