// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "map_scene.h"

#include <mrpt/opengl/CGridPlaneXY.h>
#include <mrpt/opengl/CSphere.h>

namespace engram::viewer {
namespace {

namespace gl = mrpt::opengl;

gl::CSetOfLines::Ptr lines(const gl::COpenGLScene::Ptr& scene, const mrpt::img::TColor& colour, float width) {
  auto object = gl::CSetOfLines::Create();
  object->setColor_u8(colour);
  object->setLineWidth(width);
  scene->insert(object);
  return object;
}

}  // namespace

MapScene::MapScene(double share) : scene_(gl::COpenGLScene::Create()) {
  auto grid = gl::CGridPlaneXY::Create(-100, 100, -100, 100, -0.1f, 1.0f);
  grid->setColor_u8({70, 70, 70});
  scene_->insert(grid);
  travelled_ = lines(scene_, {200, 200, 200}, 2.0f);
  closures_ = lines(scene_, {60, 220, 90}, 2.0f);
  weak_ = lines(scene_, {200, 80, 80}, 1.0f);
  path_ = lines(scene_, {90, 140, 255}, 1.5f);
  places_ = gl::CPointCloudColoured::Create();
  places_->setPointSize(9);
  scene_->insert(places_);
  robot_ = gl::CSetOfObjects::Create();
  auto ball = gl::CSphere::Create(1.0f, 12);
  ball->setColor_u8({255, 210, 0});
  robot_->insert(ball);
  robot_->setVisibility(false);
  scene_->insert(robot_);
  auto main = scene_->getViewport("main");
  main->setViewportPosition(0, 0, share, 1);
  main->setCustomBackgroundColor({0.13f, 0.13f, 0.15f});
  scene_->createViewport("panel")->setViewportPosition(share, 0, 1.0 - share, 1);
}

void MapScene::show(const MapSketch& map) {
  places_->clear();
  if (!map.places.empty()) low_ = high_ = map.places.front().at;
  for (const auto& place : map.places) {
    low_ = low_.cwiseMin(place.at);
    high_ = high_.cwiseMax(place.at);
    const mrpt::img::TColor colour =
        place.current ? mrpt::img::TColor(255, 210, 0) : mrpt::img::TColor(80, 190, 220);
    places_->insertPoint({place.at.x(), place.at.y(), place.at.z(), colour.R, colour.G, colour.B, 255});
  }
  for (auto& object : {travelled_, closures_, weak_, path_}) object->clear();
  const auto add = [](const gl::CSetOfLines::Ptr& object, const Eigen::Vector3f& a,
                      const Eigen::Vector3f& b) {
    object->appendLine(a.x(), a.y(), a.z(), b.x(), b.y(), b.z());
  };
  for (const auto& edge : map.edges) {
    const bool travelled = edge.type == map::EdgeType::kOdometry || edge.type == map::EdgeType::kCompounded;
    add(travelled ? travelled_ : edge.type == map::EdgeType::kWeak ? weak_ : closures_, edge.a, edge.b);
  }
  for (std::size_t i = 1; i < map.path.size(); ++i) add(path_, map.path[i - 1], map.path[i]);
  robot_->setVisibility(map.robot.has_value());
  if (map.robot) robot_->setLocation(map.robot->x(), map.robot->y(), map.robot->z());
  robot_->setScale(std::max(0.25f, 0.012f * extent()));  // seen in a large map as well
}

void MapScene::showPanel(const cv::Mat& panel) {
  scene_->getViewport("panel")->setImageView(mrpt::img::CImage(panel, mrpt::img::DEEP_COPY));
}

}  // namespace engram::viewer
