// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/static_place.h"

#include "common/methods.h"
#include "engram/base/interrupt.h"
#include "engram/base/parallel.h"
#include "engram/base/progress.h"
#include "engram/base/rng.h"
#include "engram/memory/models.h"
#include "engram/pipeline/place_match.h"
#include "engram/store/feature_file.h"

#include <cmath>
#include <filesystem>
#include <functional>
#include <mutex>

namespace engram::apps {
namespace fs = std::filesystem;
namespace {

constexpr double kFirstHour = 8, kLastHour = 22;
constexpr double kWalk = 60;  // [s] that people have walked at most when the picture is taken

struct Viewpoint {
  std::string name;
  world::Pose2 pose;
};

/// Is there only floor between two points?
bool inSight(const world::Plan& plan, const Eigen::Vector2d& from, const Eigen::Vector2d& window) {
  const double distance = (window - from).norm(), step = plan.cell / 8;
  for (double way = 0; way < distance; way += step) {
    const Eigen::Vector2d p = (from + (window - from) * (way / distance)) / plan.cell;
    const char cell = plan.at(static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y())));
    if (cell == '=') return (p * plan.cell - window).norm() <= plan.cell;
    if (!world::isFloor(cell)) return false;
  }
  return true;
}

std::vector<Viewpoint> chooseViewpoints(const world::World& world) {
  Viewpoint window{"window", {}}, inside{"inside", {}};
  double most = -1, least = -1;
  for (int k = 0; k < world.route().stations(); ++k) {
    const world::Pose2 pose = world.route().at(k * world.route().pitch());
    const double exposure = windowExposure(world.plan(), pose.x, pose.y);
    if (most < 0 || exposure > most) most = exposure, window.pose = pose;
    if (least < 0 || exposure < least) least = exposure, inside.pose = pose;
  }
  return {window, inside};
}

/// Takes the pictures of one day at one place.
class Watch {
 public:
  Watch(const world::World& world, const StaticPlaceParams& params, const pipeline::PipelineParams& pipeline)
      : world_(world),
        params_(params),
        eyes_(world::presetEyes("omni")),
        renderer_(eyes_.left, world.params().sensor),
        perception_(eyes_.left, pipeline.extractor) {}

  std::vector<types::Features> day(const Viewpoint& viewpoint, int day, int threads,
                                   const std::function<void()>& tick) const {
    world::Schedule schedule(world_.building(), world_.params().change);
    const world::Appearance today = schedule.session(day);
    std::vector<types::Features> features(static_cast<std::size_t>(params_.images));
    std::mutex mutex;
    base::parallelFor(features.size(), threads, [&](std::size_t i) {
      if (base::interrupted()) return;
      const double share = (static_cast<double>(i) + 0.5) / params_.images;
      const double hour = kFirstHour + (kLastHour - kFirstHour) * share;
      features[i] = perception_(picture(viewpoint, schedule.atHour(today, hour), i));
      const std::lock_guard lock(mutex);
      tick();
    });
    if (base::interrupted()) throw base::Interrupted("watching one place");
    return features;
  }

 private:
  cv::Mat picture(const Viewpoint& viewpoint, const world::Appearance& now, std::size_t i) const {
    base::Rng rng = base::Rng(world_.params().seed)
                        .fork(24000 + static_cast<std::uint64_t>(now.session))
                        .fork(i << 1 | (viewpoint.name == "window"));
    world::Pose2 pose = viewpoint.pose;
    pose.x += rng.normal(0, params_.jitter);
    pose.y += rng.normal(0, params_.jitter);
    pose.heading += rng.normal(0, params_.jitter_heading);
    const std::uint64_t walk = rng.bits(), noise = rng.bits();
    const auto people = world::walkers(world_, now.people, walk, rng.uniform(0, kWalk), pose);
    const world::Scene scene(world_.building(), now, world_.library());
    const Eigen::Isometry3d T_world_cam = types::toIsometry(pose) * eyes_.left.T_robot_cam;
    return world::renderAt(scene, renderer_, T_world_cam, people, noise);
  }

  const world::World& world_;
  StaticPlaceParams params_;
  world::Eyes eyes_;
  world::Renderer renderer_;
  pipeline::Perception perception_;
};

world::WorldParams worldParams(const StaticPlaceParams& params, std::uint64_t seed) {
  world::WorldParams world;
  world.seed = seed;
  world.change.days = 1;
  world.change.people = params.people;
  world.change.poster_share = params.poster_share;
  world.change.furniture_share = params.furniture_share;
  return world;
}

StaticPlaceResult measure(const Viewpoint& viewpoint, const std::vector<types::Features>& views,
                          const Method& method, int imagesPerDay) {
  StaticPlaceResult result;
  result.place = viewpoint.name;
  result.method = method.name;
  result.T_world_robot = viewpoint.pose;
  result.similarities = similaritiesOf(views, method.params, &result.learnt);
  std::vector<evaluation::BlockSample> samples;
  for (std::size_t i = 0; i < result.similarities.size(); ++i)
    samples.push_back({static_cast<int>(i + 1) / imagesPerDay, result.similarities[i], 1.0});
  result.mean = evaluation::blockBootstrapMean(samples);
  return result;
}

}  // namespace

void StaticPlaceParams::describe(base::Params& p) {
  p.add("days", days, "days in a row", {1, 365});
  p.add("images", images, "images a day, evenly from 8 to 22 h", {2, 10000});
  p.add("jitter", jitter, "of the position, one sigma along x and y [m]", {0, 0.2});
  p.addDegrees("jitter_heading", jitter_heading, "of the heading, one sigma [deg]", {0, 180});
  p.add("people", people, "people walking about", {0, 100});
  p.add("poster_share", poster_share, "share of the posters replaced overnight", {0, 1});
  p.add("furniture_share", furniture_share, "share of the furniture moved overnight", {0, 1});
}

double windowExposure(const world::Plan& plan, double x, double y) {
  const Eigen::Vector2d from(x, y);
  double sum = 0;
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column) {
      if (plan.at(column, row) != '=') continue;
      const Eigen::Vector2d window((column + 0.5) * plan.cell, (row + 0.5) * plan.cell);
      if (inSight(plan, from, window)) sum += 1 / std::max(1e-3, (window - from).squaredNorm());
    }
  return sum;
}

std::vector<double> similaritiesOf(const std::vector<types::Features>& views,
                                   const pipeline::PipelineParams& params, int* learnt) {
  std::vector<double> similarities;
  if (views.empty()) return similarities;
  const auto model = memory::makeMemoryModel(params.memory, params.fsh, params.multi_store);
  memory::PlaceMemory place = model->start(views.front());
  for (std::size_t i = 1; i < views.size(); ++i) {
    const auto match = pipeline::matchToPlace(views[i], place, params.match, params.verify);
    similarities.push_back(match.verified() ? match.similarity : 0.0);
    if (!pipeline::strongEnough(match, params.recognise)) continue;
    model->update(place, pipeline::inPlaceFrame(views[i], match.R_place_view), match.matches);
    if (learnt) ++*learnt;
  }
  return similarities;
}

std::vector<StaticPlaceResult> staticPlace(const StaticPlaceParams& params, const std::string& preset,
                                           const pipeline::PipelineParams& pipeline, const Workplace& place) {
  base::validate(params);
  const auto world = world::World::preset(preset, worldParams(params, place.seed));
  const Watch watch(world, params, pipeline);
  const fs::path folder = place.subfolder("static_place");
  const auto viewpoints = chooseViewpoints(world);
  base::Progress progress(place.progress, "static place");
  const double all = params.days * params.images * static_cast<double>(viewpoints.size());
  std::size_t done = 0;

  std::vector<StaticPlaceResult> results;
  for (const Viewpoint& viewpoint : viewpoints) {
    std::vector<types::Features> views;
    for (int day = 1; day <= params.days; ++day) {
      const std::string file =
          (folder / (viewpoint.name + "_day_" + std::to_string(day) + ".features")).string();
      if (!fs::exists(file))
        store::writeFeatureFile(file, watch.day(viewpoint, day, place.threads, [&] {
          ++done;
          progress.update(static_cast<double>(done) / all, done);
        }));
      for (auto& features : store::readFeatureFile(file)) views.push_back(std::move(features));
      done = views.size() +
             (&viewpoint - viewpoints.data()) * static_cast<std::size_t>(params.days * params.images);
    }
    const auto methods = staticPlaceMethods(pipeline);
    std::vector<StaticPlaceResult> here(methods.size());
    base::parallelFor(methods.size(), place.threads,
                      [&](std::size_t m) { here[m] = measure(viewpoint, views, methods[m], params.images); });
    results.insert(results.end(), here.begin(), here.end());
  }
  return results;
}

ResultTable tableOf(const std::vector<StaticPlaceResult>& results) {
  using R = StaticPlaceResult;
  Columns<R> c;
  c.add("place", &R::place).json().page("place").text("place", 8);
  c.add("method", &R::method).json().page("method").text("method", 16);
  c.add("x", [](const R& r) { return r.T_world_robot.x; }).json();
  c.add("y", [](const R& r) { return r.T_world_robot.y; }).json();
  c.add("mean_similarity", &R::mean)
      .json("", "mean_similarity_95")
      .page("similarity [%]", percent(1))
      .text("similarity [%]", 21, percent(1));
  c.add("learnt", &R::learnt).json().page("learnt from");
  c.add("", [](const R& r) {
     return line("learnt from %d of %zu", r.learnt, r.similarities.size());
   }).text("", 0);
  c.add("similarities", [](const R& r) { return nlohmann::json(r.similarities); }).json();
  return c.table(results);
}

std::string toText(const std::vector<StaticPlaceResult>& results) {
  return tableOf(results).toText("A robot that stands still, mean similarity [%] to what it remembers:") +
         "paper    fsh               88.8\npaper    static            58.2\n";
}

}  // namespace engram::apps
