// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/exporters/exporters.h"

#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/map/graph.h"
#include "engram/posegraph/mrpt_graph.h"
#include "exporter_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/graphs/CNetworkOfPoses.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/opengl/CSphere.h>
#include <mrpt/opengl/CText.h>
#include <mrpt/opengl/CTexturedPlane.h>
#include <opencv2/imgcodecs.hpp>

#include <sstream>

namespace engram::exporters {
namespace {

using ::testing::HasSubstr;

template <class T>
typename T::Ptr named(mrpt::opengl::COpenGLScene& scene, const std::string& name) {
  return std::dynamic_pointer_cast<T>(scene.getByName(name));
}

TEST_F(ExporterTest, SceneHoldsTheMap) {
  writeScene(path("m.3Dscene"), map_);
  mrpt::opengl::COpenGLScene scene;
  ASSERT_TRUE(scene.loadFromFile(path("m.3Dscene")));
  const auto places = named<mrpt::opengl::CSetOfObjects>(scene, "places");
  ASSERT_TRUE(places);
  ASSERT_EQ(places->size(), map_.places().size());
  std::size_t i = 0;
  for (const auto& [id, place] : map_.places()) {
    const auto sphere =
        std::dynamic_pointer_cast<mrpt::opengl::CSphere>(*(places->begin() + static_cast<long>(i++)));
    ASSERT_TRUE(sphere);
    const auto at = sphere->getPose();
    EXPECT_NEAR((Eigen::Vector3d(at.x, at.y, at.z) - place.T_map_place.translation()).norm(), 0, 1e-4);
  }
  EXPECT_EQ(named<mrpt::opengl::CSetOfLines>(scene, "edges: odometry")->getLineCount(), 5u);
  EXPECT_EQ(named<mrpt::opengl::CSetOfLines>(scene, "edges: loop")->getLineCount(), 1u);
  EXPECT_EQ(named<mrpt::opengl::CSetOfLines>(scene, "edges: recognition")->getLineCount(), 2u);
  EXPECT_EQ(named<mrpt::opengl::CSetOfLines>(scene, "path of session 0")->getLineCount(), 5u);
  const auto numbers = named<mrpt::opengl::CSetOfObjects>(scene, "place numbers");
  EXPECT_EQ(std::dynamic_pointer_cast<mrpt::opengl::CText>(*numbers->begin())->getString(), "0");
  EXPECT_FALSE(scene.getByName("image of place 0"));
}

TEST_F(ExporterTest, SceneShowsMoreImagesThanAViewerHasTextures) {
  cv::Mat picture(48, 64, CV_8UC3, cv::Scalar(20, 120, 220));
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", picture, jpeg);
  for (int i = 0; i < 300; ++i) {
    map::Place place;
    place.T_map_place = testing::planarPose(i, 20, 0.1 * i);
    map::View view{.place = map_.addPlace(place)};
    view.jpeg = i == 7 ? std::vector<std::uint8_t>{1, 2, 3} : jpeg;  // a damaged picture is left out
    map_.addView(view);
  }
  writeScene(path("m.3Dscene"), map_, {.images = true});
  mrpt::opengl::COpenGLScene scene;
  ASSERT_TRUE(scene.loadFromFile(path("m.3Dscene")));
  std::size_t pictures = 0;
  for (const auto& [id, place] : map_.places()) {
    const auto plane =
        named<mrpt::opengl::CTexturedPlane>(scene, "image of place " + std::to_string(id.value));
    if (!plane) continue;
    ++pictures;
    EXPECT_EQ(plane->getTextureImage().getWidth(), 64u);
    const auto at = plane->getPose();
    EXPECT_NEAR((Eigen::Vector2d(at.x, at.y) - place.T_map_place.translation().head<2>()).norm(), 0, 1e-4);
    EXPECT_GT(at.z, 0.3);
  }
  EXPECT_GE(pictures, 140u);  // every second of 300
  EXPECT_LE(pictures, 180u);
  // They stand upright: the texture's up is the world's.
  const auto plane = named<mrpt::opengl::CTexturedPlane>(scene, "image of place 9");
  ASSERT_TRUE(plane);
  const mrpt::poses::CPose3D pose(plane->getPose());
  EXPECT_NEAR(pose.getRotationMatrix()(2, 1), 1, 1e-6);
}

TEST_F(ExporterTest, EmptyMapsCanBeExported) {
  const map::TopologicalMap empty;
  writeScene(path("a.3Dscene"), empty, {.images = true});
  writeGraph(path("a.graph"), empty);
  writeTum(path("a.tum"), empty);
  writeDot(path("a.dot"), empty);
  mrpt::opengl::COpenGLScene scene;
  EXPECT_TRUE(scene.loadFromFile(path("a.3Dscene")));
}

TEST_F(ExporterTest, GraphIsReadByMrptWithAllDigits) {
  writeGraph(path("m.graph"), map_);
  mrpt::graphs::CNetworkOfPoses3DInf read;
  read.loadFromTextFile(path("m.graph"));
  const auto written = posegraph::toMrpt(map::toGraph(map_));
  ASSERT_EQ(read.nodes.size(), map_.places().size());
  ASSERT_EQ(read.edges.size(), 9u);  // ten, of which one has no scale
  EXPECT_EQ(read.root, 0u);
  for (const auto& [id, pose] : written.nodes)
    EXPECT_NEAR((read.nodes.at(id).asVectorVal() - pose.asVectorVal()).norm(), 0, 1e-12) << id;
  auto it = read.edges.begin();
  for (const auto& [ends, edge] : written.edges) {
    EXPECT_EQ(it->first, ends);
    EXPECT_NEAR((it->second.mean.asVectorVal() - edge.mean.asVectorVal()).norm(), 0, 1e-12);
    EXPECT_TRUE(it->second.cov_inv.asEigen().isApprox(edge.cov_inv.asEigen(), 1e-12));
    ++it;
  }
}

TEST_F(ExporterTest, TumHoldsThePathInTheMapFrame) {
  writeTum(path("m.tum"), map_);
  std::ifstream in(path("m.tum"));
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line[0], '#');
  for (const auto& point : map_.path()) {
    double stamp = 0, x = 0, y = 0, z = 0, qx = 0, qy = 0, qz = 0, qw = 0;
    ASSERT_TRUE(in >> stamp >> x >> y >> z >> qx >> qy >> qz >> qw);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() << x, y, z;
    T.linear() = Eigen::Quaterniond(qw, qx, qy, qz).toRotationMatrix();
    EXPECT_NEAR(stamp, point.stamp, 1e-6);
    EXPECT_TRUE(T.isApprox(map_.T_map_robot(point), 1e-8));
  }
  EXPECT_FALSE(in >> line);
}

TEST_F(ExporterTest, DotNamesEveryEdge) {
  writeDot(path("m.dot"), map_);
  const std::string dot = read(path("m.dot"));
  for (const auto& [id, e] : map_.edges())
    EXPECT_THAT(dot, HasSubstr(std::to_string(e.a.value) + " -- " + std::to_string(e.b.value) +
                               " [class=" + map::toString(e.type)));
}

TEST_F(ExporterTest, NothingIsOverwrittenUnlessAsked) {
  const auto message = [&](auto&& write) {
    try {
      write();
    } catch (const base::Error& e) {
      return std::string(e.what());
    }
    return std::string("no base::Error");
  };
  base::writeText(path("m"), "precious");
  EXPECT_THAT(message([&] { writeScene(path("m"), map_); }), HasSubstr("exists already"));
  EXPECT_THAT(message([&] { writeGraph(path("m"), map_); }), HasSubstr("exists already"));
  EXPECT_THAT(message([&] { writeTum(path("m"), map_); }), HasSubstr("exists already"));
  EXPECT_THAT(message([&] { writeDot(path("m"), map_); }), HasSubstr("exists already"));
  EXPECT_EQ(read(path("m")), "precious");
  base::writeText(path("m"), "new", true);
  EXPECT_EQ(read(path("m")), "new");
  EXPECT_THAT(message([&] { writeTum(path("no/such/m"), map_); }), HasSubstr("does not exist"));
  EXPECT_THAT(message([&] { writeTum(folder_.string(), map_, true); }), HasSubstr("is a folder"));
  EXPECT_THAT(message([&] { base::writeText("/proc/engram", "x"); }), HasSubstr("/proc/engram"));
  // No temporary file is left behind.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

}  // namespace
}  // namespace engram::exporters
