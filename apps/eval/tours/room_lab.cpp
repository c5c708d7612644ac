// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tours/room_lab.h"

#include "common/methods.h"
#include "engram/base/interrupt.h"
#include "engram/base/parallel.h"
#include "engram/base/progress.h"
#include "engram/pipeline/perception.h"
#include "engram/store/feature_file.h"
#include "tours/tours_lab.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <mutex>

namespace engram::apps {
namespace fs = std::filesystem;
namespace {

constexpr double kRoomRadius = 4;  // [m] within which floor makes a place spacious

int floorAround(const world::Plan& plan, const world::Pose2& pose) {
  int cells = 0;
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column) {
      const Eigen::Vector2d middle((column + 0.5) * plan.cell, (row + 0.5) * plan.cell);
      const bool near = (middle - Eigen::Vector2d(pose.x, pose.y)).norm() < kRoomRadius;
      cells += near && world::isFloor(plan.at(column, row));
    }
  return cells;
}

/// Way along the route to its most spacious station [m].
double middleOfTheRoom(const world::World& world) {
  const world::Route& route = world.route();
  double best = 0;
  int most = -1;
  for (int k = 0; k < route.stations(); ++k) {
    const double arc = k * route.pitch();
    const int floor = floorAround(world.plan(), route.at(arc));
    if (floor > most) most = floor, best = arc;
  }
  return best;
}

/// Each image is a session of its own: what was changed by hand before it.
world::WorldParams changedByHand(const RoomParams& params, std::uint64_t seed) {
  world::WorldParams world;
  world.seed = seed;
  world.change.light = false;
  world.change.people = 0;
  world.change.door_share = 0;
  world.change.poster_share = params.poster_share;
  world.change.furniture_share = params.furniture_share;
  world.change.sudden_share = params.rearranged_share;
  for (int i = params.rearranged_every; i < params.images; i += params.rearranged_every)
    world.change.sudden_sessions += (world.change.sudden_sessions.empty() ? "" : ",") + std::to_string(i + 1);
  return world;
}

std::vector<types::Features> roomViews(const world::World& world, const RoomParams& params,
                                       const pipeline::PipelineParams& pipeline, const Workplace& place) {
  const world::Eyes eyes = world::presetEyes("omni");
  const pipeline::Perception perception(eyes.left, pipeline.extractor);
  const double arc = middleOfTheRoom(world);
  world::Schedule schedule(world.building(), world.params().change);
  std::vector<world::Appearance> looks;
  for (int i = 1; i <= params.images; ++i) looks.push_back(schedule.session(i));
  std::vector<types::Features> views(looks.size());
  base::Progress progress(place.progress, "room");
  std::mutex mutex;
  std::size_t done = 0;
  base::parallelFor(views.size(), place.threads, [&](std::size_t i) {
    if (base::interrupted()) return;
    const world::Pose2 pose = roomPose(world.route(), arc, params, static_cast<int>(i));
    views[i] = perception(world::renderAt(world, looks[i], eyes.left, pose));
    const std::lock_guard lock(mutex);
    ++done;
    progress.update(static_cast<double>(done) / params.images, done);
  });
  if (base::interrupted()) throw base::Interrupted("looking round the room");
  return views;
}

RoomResult oneMemory(const std::vector<types::Features>& views, const Method& method,
                     const RoomParams& params) {
  RoomResult result;
  result.method = method.name;
  TourMemory memory(method.params, {views.front()}, true);
  std::vector<evaluation::BlockSample> samples;
  double sum = 0, squares = 0;
  for (std::size_t i = 1; i < views.size(); ++i) {
    const TourQuery query = memory.see(views[i]);
    result.matched.push_back(query.matched);
    result.learnt += query.learnt;
    const auto longTerm = static_cast<int>(memory.places().front().longTerm().size());
    result.longTerm.push_back(longTerm);
    result.shortTerm.push_back(static_cast<int>(memory.places().front().features.size()) - longTerm);
    samples.push_back(
        {static_cast<int>(i) / params.rearranged_every, static_cast<double>(query.matched), 1.0});
    sum += query.matched;
    squares += static_cast<double>(query.matched) * query.matched;
  }
  const double n = std::max<double>(1, static_cast<double>(result.matched.size()));
  result.mean = evaluation::blockBootstrapMean(samples);
  result.sigma = std::sqrt(std::max(0.0, squares / n - (sum / n) * (sum / n)));
  return result;
}

double meanCount(const std::vector<int>& values) {
  double sum = 0;
  for (const int v : values) sum += v;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

}  // namespace

void RoomParams::describe(base::Params& p) {
  p.add("images", images, "images of the room; the first one is the reference view", {2, 100000});
  p.add("reach", reach, "way to both sides of it, back and forth [m]", {0, 10});
  p.add("period", period, "images of one way back and forth", {1, 10000});
  p.add("poster_share", poster_share, "share of the posters changed before each image", {0, 1});
  p.add("furniture_share", furniture_share, "share of the furniture moved before each image", {0, 1});
  p.add("rearranged_every", rearranged_every, "images from one large change to the next", {1, 100000});
  p.add("rearranged_share", rearranged_share, "share of posters and furniture that it changes", {0, 1});
}

world::Pose2 roomPose(const world::Route& route, double arc, const RoomParams& params, int i) {
  const double offset = params.reach * std::sin(2 * M_PI * i / params.period);
  return route.at(arc + offset);
}

std::vector<RoomResult> roomResults(const std::vector<types::Features>& views,
                                    const std::vector<Method>& methods, const RoomParams& params,
                                    int threads) {
  std::vector<RoomResult> results(methods.size());
  base::parallelFor(methods.size(), threads,
                    [&](std::size_t m) { results[m] = oneMemory(views, methods[m], params); });
  return results;
}

std::vector<RoomResult> room(const RoomParams& params, const std::string& preset,
                             const pipeline::PipelineParams& pipeline, const Workplace& place) {
  base::validate(params);
  const std::string file = place.subfolder("room") + "/views.features";
  if (!fs::exists(file)) {
    const auto world = world::World::preset(preset, changedByHand(params, place.seed));
    store::writeFeatureFile(file, roomViews(world, params, pipeline, place));
  }
  return roomResults(store::readFeatureFile(file), touredMethods(pipeline), params, place.threads);
}

ResultTable tableOf(const std::vector<RoomResult>& results) {
  using R = RoomResult;
  Columns<R> c;
  c.add("method", &R::method).json().page("method").text("method", 16);
  c.add("images", [](const R& r) { return r.matched.size(); }).json();
  c.add("mean_matched", &R::mean)
      .json("", "mean_matched_95")
      .page("points matched", fixed(1), charts::Best::kLargest)
      .text("points matched", 22, fixed(1));
  c.add("sd_matched", &R::sigma).json().page("their deviation", fixed(1)).text("deviation", 11, fixed(1));
  c.add("mean_ltm", [](const R& r) { return meanCount(r.longTerm); })
      .json()
      .page("long-term", fixed(0))
      .text("long-term", 11, fixed(0));
  c.add("mean_stm", [](const R& r) { return meanCount(r.shortTerm); })
      .json()
      .page("short-term", fixed(0))
      .text("short-term", 12, fixed(0));
  c.add("learnt", &R::learnt).json().page("learnt from").text("learnt from", 0);
  return c.table(results);
}

std::string toText(const std::vector<RoomResult>& results) {
  return "One room, changed by hand from image to image (D-09):\n" + tableOf(results).toText() +
         "paper, adaptive  98.8                  18.7\n"
         "paper, static    45.2                  25.4\n";
}

}  // namespace engram::apps
