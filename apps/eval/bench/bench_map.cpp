// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench_map.h"

#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/parallel.h"
#include "engram/base/progress.h"
#include "engram/memory/models.h"
#include "engram/pipeline/perception.h"
#include "engram/store/map_file.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <filesystem>
#include <numbers>

namespace engram::apps {
namespace {

constexpr std::size_t kRow = 50;      // places before the way turns back
constexpr double kStepSigma = 0.05;   // [m] and [rad]
constexpr std::size_t kAtOnce = 256;  // places between two looks at Ctrl-C

Eigen::Isometry3d poseOf(std::size_t i, double spacing) {
  const std::size_t row = i / kRow, column = i % kRow;
  const bool back = row % 2 == 1;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << spacing * static_cast<double>(back ? kRow - 1 - column : column),
      spacing * static_cast<double>(row), 0;
  if (back) T.linear() = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

std::vector<std::uint8_t> thumbnail(const cv::Mat& image, int width) {
  std::vector<std::uint8_t> jpeg;
  if (width <= 0) return jpeg;
  cv::Mat small;
  cv::resize(image, small, {width, std::max(1, image.rows * width / image.cols)}, 0, 0, cv::INTER_AREA);
  cv::imencode(".jpg", small, jpeg);
  return jpeg;
}

/// One place and its picture.
struct Made {
  types::Features features;
  std::vector<std::uint8_t> jpeg;
};

void add(map::TopologicalMap& map, Made made, const memory::MemoryModel& model, double spacing) {
  const std::size_t i = map.places().size();
  map::Place place;
  place.T_map_place = poseOf(i, spacing);
  place.memory = model.start(std::move(made.features));
  place.createdIndex = i;
  place.createdStamp = static_cast<double>(i);
  const Eigen::Isometry3d T_map_here = place.T_map_place;
  const base::PlaceId id = map.addPlace(std::move(place));
  if (!made.jpeg.empty())
    map.addView(
        {.place = id, .stamp = static_cast<double>(i), .frameIndex = i, .jpeg = std::move(made.jpeg)});
  if (i == 0) return;
  map::Edge edge{.a = base::PlaceId(id.value - 1), .b = id};
  edge.T_a_b.T_a_b = poseOf(i - 1, spacing).inverse() * T_map_here;
  edge.T_a_b.cov = types::Matrix6d::Identity() * (kStepSigma * kStepSigma);
  map.addEdge(std::move(edge));
}

/// The file has its name when it is whole.
void write(const map::TopologicalMap& map, const map::MapHeader& header, const std::string& file) {
  const std::string unfinished = file + ".part";
  store::MapFile made = store::MapFile::create(unfinished, header, true);
  map::Cursor all;
  made.commit(map, map.changesSince(all));
  made.close();
  std::filesystem::rename(unfinished, file);
}

}  // namespace

types::Frame benchFrame(const BenchImages& images, const pipeline::PipelineParams& params, std::size_t i,
                        bool again, bool wheels) {
  types::Frame frame;
  frame.index = i;
  frame.stamp = static_cast<double>(i);
  frame.image = again ? images.query(i) : images.place(i);
  if (wheels) frame.T_odom_robot = poseOf(i, params.place.spacing);
  return frame;
}

void makeBenchMap(const BenchImages& images, const pipeline::PipelineParams& params, std::size_t places,
                  const std::string& file, const Workplace& place) {
  if (std::filesystem::exists(file)) return;
  pipeline::Perception perception(params.camera, params.extractor);
  if (const std::string why = perception.refusal(images.place(0)); !why.empty()) throw base::Error(why);
  const auto model = memory::makeMemoryModel(params.memory, params.fsh, params.multi_store);
  map::TopologicalMap map;
  base::Progress progress(place.progress, "map of " + std::to_string(places) + " places");
  for (std::size_t first = 0; first < places; first += kAtOnce) {
    if (base::interrupted()) throw base::Interrupted("making a map");
    std::vector<Made> made(std::min(kAtOnce, places - first));
    base::parallelFor(made.size(), place.threads, [&](std::size_t k) {
      const cv::Mat image = images.place(first + k);
      made[k] = {perception(image), thumbnail(image, params.place.keep_thumbnails)};
    });
    for (Made& one : made) add(map, std::move(one), *model, params.place.spacing);
    progress.update(static_cast<double>(first) / static_cast<double>(places), first);
  }
  write(map, perception.mapHeader(params.memory.memory), file);
}

}  // namespace engram::apps
