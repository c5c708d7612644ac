// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/base/image_header.h"
#include "engram/exporters/exporters.h"
#include "engram/map/picture.h"
#include "map_colours.h"

#include <mrpt/io/CMemoryStream.h>
#include <mrpt/opengl/CGridPlaneXY.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/opengl/CSphere.h>
#include <mrpt/opengl/CText.h>
#include <mrpt/opengl/CTexturedPlane.h>
#include <mrpt/opengl/stock_objects.h>
#include <mrpt/serialization/CArchive.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <zlib.h>

namespace engram::exporters {
namespace {

namespace gl = mrpt::opengl;
using charts::Colour;
using mrpt::img::TColor;
using mrpt::img::TColorf;

/// More spheres or labels than these make the viewer slow and the picture unreadable.
constexpr std::size_t kMaxSpheres = 2000, kMaxLabels = 200;
/// MRPT floods stderr when more than 192 textures are seen. (An atlas cannot help: the file format of 2.5
/// drops the texture coordinates of CSetOfTexturedTriangles.)
constexpr std::size_t kMaxImages = 180;
constexpr double kPathHeight = 0.02, kLabelHeight = 0.35;  // [m]

TColor toMrpt(Colour c) { return {c.r, c.g, c.b}; }

struct Extent {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300), high = Eigen::Vector3d::Constant(-1e300);
  void add(const Eigen::Vector3d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
};

Extent extentOf(const map::TopologicalMap& map) {
  Extent e;
  for (const auto& [id, place] : map.places()) e.add(place.T_map_place.translation());
  for (const auto& point : map.path()) e.add(map.T_map_robot(point).translation());
  if (map.empty()) e.add(Eigen::Vector3d::Zero());
  return e;
}

/// Median length of the edges, as a measure for the size of what is drawn.
double typicalStep(const map::TopologicalMap& map) {
  std::vector<double> lengths;
  for (const auto& [id, e] : map.edges())
    lengths.push_back(
        (map.place(e.a).T_map_place.translation() - map.place(e.b).T_map_place.translation()).norm());
  if (lengths.empty()) return 1.0;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return std::clamp(*middle, 0.05, 5.0);
}

gl::CRenderizable::Ptr ground(const Extent& e) {
  const double size = std::max({e.high.x() - e.low.x(), e.high.y() - e.low.y(), 4.0});
  const double step = size < 60 ? 1.0 : size < 600 ? 10.0 : 100.0;
  const auto down = [&](double v) { return static_cast<float>(std::floor(v / step - 1) * step); };
  const auto up = [&](double v) { return static_cast<float>(std::ceil(v / step + 1) * step); };
  auto grid = gl::CGridPlaneXY::Create(down(e.low.x()), up(e.high.x()), down(e.low.y()), up(e.high.y()),
                                       static_cast<float>(e.low.z() - 0.1), static_cast<float>(step));
  grid->setColor_u8(TColor(200, 200, 200));
  grid->setName("grid, squares of " + std::to_string(static_cast<int>(step)) + " m");
  return grid;
}

gl::CRenderizable::Ptr places(const map::TopologicalMap& map, double radius) {
  auto group = gl::CSetOfObjects::Create();
  group->setName("places");
  const double most = largestLongTerm(map.content());
  auto cloud = gl::CPointCloudColoured::Create();
  cloud->setPointSize(8);
  for (const auto& [id, place] : map.places()) {
    const Colour colour = charts::viridis(static_cast<double>(place.memory->longTerm().size()) / most);
    const Eigen::Vector3d t = place.T_map_place.translation();
    if (map.places().size() > kMaxSpheres) {
      cloud->insertPoint({static_cast<float>(t.x()), static_cast<float>(t.y()), static_cast<float>(t.z()),
                          colour.r, colour.g, colour.b, 255});
      continue;
    }
    auto sphere = gl::CSphere::Create(static_cast<float>(radius), 12);
    sphere->setLocation(t.x(), t.y(), t.z());
    sphere->setColor_u8(toMrpt(colour));
    sphere->setName("place " + std::to_string(id.value));
    group->insert(sphere);
  }
  if (map.places().size() > kMaxSpheres) group->insert(cloud);
  return group;
}

gl::CRenderizable::Ptr labels(const map::TopologicalMap& map, double height) {
  auto group = gl::CSetOfObjects::Create();
  group->setName("place numbers");
  const std::size_t every = map.places().size() / kMaxLabels + 1;
  std::size_t i = 0;
  for (const auto& [id, place] : map.places()) {
    if (i++ % every != 0) continue;
    auto text = gl::CText::Create(std::to_string(id.value));
    text->setFont("sans", 14);
    text->setColor_u8(TColor(20, 20, 20));
    const Eigen::Vector3d t = place.T_map_place.translation();
    text->setLocation(t.x(), t.y(), t.z() + height);
    group->insert(text);
  }
  return group;
}

gl::CRenderizable::Ptr edges(const map::TopologicalMap& map, map::EdgeType type) {
  auto lines = gl::CSetOfLines::Create();
  lines->setName(std::string("edges: ") + map::toString(type));
  lines->setColor_u8(toMrpt(edgeColour(type)));
  lines->setLineWidth(type == map::EdgeType::kOdometry ? 1.5f : 3.0f);
  for (const auto& [id, e] : map.edges()) {
    if (e.type != type) continue;
    const Eigen::Vector3d a = map.place(e.a).T_map_place.translation(),
                          b = map.place(e.b).T_map_place.translation();
    lines->appendLine(a.x(), a.y(), a.z(), b.x(), b.y(), b.z());
  }
  return lines;
}

std::vector<gl::CRenderizable::Ptr> paths(const map::TopologicalMap& map) {
  std::map<int, gl::CSetOfLines::Ptr> ofSession;
  for (std::size_t i = 1; i < map.path().size(); ++i) {
    const auto &from = map.path()[i - 1], &to = map.path()[i];
    if (from.session != to.session) continue;
    auto& lines = ofSession[to.session];
    if (!lines) {
      lines = gl::CSetOfLines::Create();
      lines->setName("path of session " + std::to_string(to.session));
      lines->setColor_u8(toMrpt(charts::categoryColour(static_cast<std::size_t>(to.session))));
      lines->setLineWidth(2.0f);
    }
    const Eigen::Vector3d a = map.T_map_robot(from).translation(), b = map.T_map_robot(to).translation();
    lines->appendLine(a.x(), a.y(), a.z() + kPathHeight, b.x(), b.y(), b.z() + kPathHeight);
  }
  std::vector<gl::CRenderizable::Ptr> out;
  for (const auto& [session, lines] : ofSession) out.push_back(lines);
  return out;
}

/// The picture of the place, upright above it, as the robot saw it that looks along its x axis.
gl::CRenderizable::Ptr picture(const cv::Mat& image, const map::Place& place, double width) {
  const auto w = static_cast<float>(width / 2);
  const float h = w * static_cast<float>(image.rows) / static_cast<float>(image.cols);
  auto plane = gl::CTexturedPlane::Create(-w, w, -h, h);
  plane->assignImage(mrpt::img::CImage(image, mrpt::img::DEEP_COPY));
  static_cast<gl::CRenderizableShaderTexturedTriangles&>(*plane).enableLight(false);
  // The plane's x is the robot's right, its y is up.
  Eigen::Isometry3d T_place_plane = Eigen::Isometry3d::Identity();
  T_place_plane.linear() << 0, 0, -1, -1, 0, 0, 0, 1, 0;
  T_place_plane.translation().z() = h + kLabelHeight + 0.5 * width;
  const Eigen::Isometry3d T = place.T_map_place * T_place_plane;
  plane->setPose(mrpt::poses::CPose3D(mrpt::math::CMatrixDouble44(T.matrix())));
  plane->setName("image of place " + std::to_string(place.id.value));
  return plane;
}

/// The first picture of each place, as more would hide each other; of a large map every second, third, …
/// place.
std::vector<gl::CRenderizable::Ptr> images(const map::TopologicalMap& map, double step) {
  std::map<map::PlaceId, const map::View*> first;
  for (const auto& [id, view] : map.views())
    if (!view.jpeg.empty()) first.try_emplace(view.place, &view);
  const std::size_t every = (first.size() + kMaxImages - 1) / kMaxImages;
  std::vector<gl::CRenderizable::Ptr> out;
  std::size_t i = 0;
  for (const auto& [place, view] : first) {
    if (i++ % every != 0 || !map::brokenPicture(view->jpeg).empty()) continue;
    const cv::Mat image = cv::imdecode(view->jpeg, cv::IMREAD_COLOR);
    if (!image.empty()) out.push_back(picture(image, map.place(place), 0.8 * step));
  }
  return out;
}

gl::COpenGLScene sceneOf(const map::TopologicalMap& map, bool withImages) {
  gl::COpenGLScene scene;
  const double step = typicalStep(map);
  const Extent extent = extentOf(map);
  scene.getViewport()->setCustomBackgroundColor(TColorf(1.0f, 1.0f, 1.0f));
  const double size = (extent.high - extent.low).norm();
  auto origin = gl::stock_objects::CornerXYZSimple(static_cast<float>(step), 2.0f);
  origin->setName("map frame");
  scene.insert(origin);
  for (const map::EdgeType type : kEdgeTypes) scene.insert(edges(map, type));
  for (const auto& path : paths(map)) scene.insert(path);
  scene.insert(places(map, 0.15 * step));
  scene.insert(labels(map, 0.3 * step));
  if (withImages)
    for (const auto& object : images(map, step)) scene.insert(object);
  scene.insert(ground(extent));
  auto& camera = scene.getViewport()->getCamera();
  const Eigen::Vector3d middle = (extent.low + extent.high) / 2;
  camera.setPointingAt(static_cast<float>(middle.x()), static_cast<float>(middle.y()),
                       static_cast<float>(middle.z()));
  camera.setZoomDistance(static_cast<float>(1.3 * std::max(size, 3.0)));
  camera.setAzimuthDegrees(-90);
  camera.setElevationDegrees(55);
  return scene;
}

/// MRPT's own function goes through a file in /tmp, and does not notice when that disk is full.
std::string gzipped(const void* data, std::size_t size) {
  constexpr int kGzip = 15 + 16;  // window bits, with the header of gzip
  z_stream stream{};
  deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, size), '\0');
  stream.next_in = static_cast<Bytef*>(const_cast<void*>(data));
  stream.avail_in = static_cast<uInt>(size);
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int result = deflate(&stream, Z_FINISH);
  packed.resize(packed.size() - stream.avail_out);
  deflateEnd(&stream);
  if (result != Z_STREAM_END) throw base::Error("the scene cannot be compressed");
  return packed;
}

}  // namespace

void writeScene(const std::string& path, const map::TopologicalMap& map, const SceneOptions& options) {
  const bool jpegWasOff = mrpt::img::CImage::DISABLE_JPEG_COMPRESSION();
  mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(false);  // otherwise the textures are stored raw
  // In memory first: MRPT's saveToFile() does not notice a full disk.
  mrpt::io::CMemoryStream memory;
  mrpt::serialization::archiveFrom(memory) << sceneOf(map, options.images);
  mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(jpegWasOff);
  base::writeText(path, gzipped(memory.getRawBufferData(), memory.getTotalBytesCount()), options.overwrite);
}

}  // namespace engram::exporters
