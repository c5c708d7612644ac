// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Experiments at single spots: no drive, one camera that is put here and there.
#include "engram/base/rng.h"
#include "engram/pipeline/perception.h"
#include "engram/pipeline/place_match.h"
#include "engram/upkeep/clusters.h"
#include "engram/upkeep/lru.h"
#include "views/views_world.h"

#include <cmath>
#include <functional>
#include <memory>

namespace engram::apps {
namespace {

using world::Appearance;
using world::Pose2;

/// The stereo camera at any pose of a building that looks in some way.
class Spot {
 public:
  Spot(const world::World& world, const Appearance& appearance, const world::Eyes& eyes,
       const pipeline::PipelineParams& params)
      : appearance_(std::make_unique<Appearance>(appearance)),
        scene_(world.building(), *appearance_, world.library(), 1),
        eyes_(eyes),
        left_(eyes.left, world.params().sensor),
        right_(*eyes.right, world.params().sensor),
        perception_(params.camera, params.extractor),
        params_(params) {}

  types::Features look(const Pose2& pose, std::uint64_t seed,
                       const std::vector<world::Pillar>& people = {}) const {
    types::Frame frame;
    const Eigen::Isometry3d T = types::toIsometry(pose);
    frame.image = world::renderAt(scene_, left_, T * eyes_.left.T_robot_cam, people, seed);
    frame.right = world::renderAt(scene_, right_, T * eyes_.right->T_robot_cam, people, seed + 1);
    return pipeline::viewFeatures(perception_, perception_.rectified(frame), params_.views.max_features);
  }

  const pipeline::StereoCamera& camera() const { return *perception_.stereo(); }

 private:
  std::unique_ptr<const Appearance> appearance_;  // the scene refers to it
  world::Scene scene_;
  world::Eyes eyes_;
  world::Renderer left_, right_;
  pipeline::Perception perception_;
  pipeline::PipelineParams params_;
};

/// Matches that geometry confirms; 0 when it refuses.
int inliersOf(const types::Features& a, const types::Features& b, const pipeline::PipelineParams& params,
              const types::StereoModel& model) {
  const auto matches = features::match(a, b, params.match);
  const auto verified = geometry::verifyStereo(a, b, matches, model, params.stereo);
  return verified.ok() ? static_cast<int>(verified.inliers.size()) : 0;
}

/// Poses of the tour where it goes straight on for two metres.
std::vector<Pose2> straightPoses(const world::Route& route, int count) {
  std::vector<Pose2> straight;
  for (double s = 0; s < route.length(); s += 0.5) {
    const Pose2 here = route.at(s), ahead = route.at(s + 2);
    const Pose2 step = between(here, ahead);
    if (std::abs(step.y) < 0.1 && std::abs(step.heading) < 0.05) straight.push_back(here);
  }
  std::vector<Pose2> poses;
  const auto n = static_cast<double>(straight.size());
  for (int k = 0; k < std::min(count, static_cast<int>(straight.size())); ++k)
    poses.push_back(straight[static_cast<std::size_t>(k * n / count)]);
  return poses;
}

/// Somebody who stands in front of the camera, half a metre away.
std::vector<world::Pillar> somebodyBefore(const world::World& world, const Pose2& robot) {
  const Pose2 at = compose(robot, Pose2{0.5, 0, 0});
  world::Pillar person;
  person.centre = Eigen::Vector2d(at.x, at.y).cast<float>();
  person.heading = static_cast<float>(robot.heading);
  person.texture = world.library().people.front();
  return {person};
}

/// What a spot looks like at each look.
struct EnvironmentClass {
  std::string name, about;
  std::function<int(int)> appearance;  ///< of a look: which of the appearances
  std::function<bool(int)> blocked;    ///< somebody stands in front
};

std::vector<EnvironmentClass> environmentClasses(int looks) {
  const auto always = [](int) { return 0; };
  const auto never = [](int) { return false; };
  const auto once = [looks](int look) { return look == looks / 2; };
  return {{"static", "nothing changes", always, never},
          {"small changes", "a poster or a piece of furniture at a time", [](int look) { return look / 5; },
           never},
          {"abrupt", "half-way everything that can be moved is elsewhere",
           [looks](int look) { return look < looks / 2 ? 0 : -1; }, never},
          {"repetitive", "two states in turn, three looks each",
           [](int look) { return look / 3 % 2 == 0 ? 0 : -1; }, never},
          {"ephemeral", "somebody stands in front of the camera at one look", always, once},
          {"mixture", "small changes, an abrupt one, and somebody in front once",
           [looks](int look) { return look < looks * 3 / 4 ? look / 5 : -1; }, once}};
}

/// Poses at this distance ahead, behind and to both sides, turned by this angle to either side in turn.
std::vector<Pose2> allRound(const Pose2& pose, const OffsetCell& cell) {
  std::vector<Pose2> poses;
  double turn = cell.angle;
  for (const double way : {0.0, M_PI, M_PI / 2, -M_PI / 2}) {
    poses.push_back(compose(pose, Pose2{cell.distance * std::cos(way), cell.distance * std::sin(way), turn}));
    turn = -turn;
    if (cell.distance == 0 && poses.size() == 2) break;
  }
  return poses;
}

bool onFloor(const world::Plan& plan, const Pose2& pose) {
  return world::isFloor(plan.at(static_cast<int>(std::floor(pose.x / plan.cell)),
                                static_cast<int>(std::floor(pose.y / plan.cell))));
}

}  // namespace

std::vector<OffsetCell> ViewsWorld::offsets() const {
  const Spot spot(*building_, building_->appearance(1), eye_.eyes, eye_.pipeline);
  const std::vector<Pose2> poses = straightPoses(building_->route(), params_.poses);
  std::vector<OffsetCell> cells;
  for (const double distance : {0.0, 0.25, 0.5, 0.75, 1.0, 1.5})
    for (const double degrees : {0.0, 10.0, 20.0, 30.0}) cells.push_back({distance, degrees * M_PI / 180});
  std::uint64_t seed = 1000;
  for (const Pose2& pose : poses) {
    const types::Features reference = spot.look(pose, seed += 2);
    for (OffsetCell& cell : cells)
      for (const Pose2& beside : allRound(pose, cell)) {
        seed += 2;
        if (!onFloor(building_->plan(), beside)) continue;
        ++cell.tried;
        cell.recognised += inliersOf(spot.look(beside, seed), reference, eye_.pipeline,
                                     spot.camera().model) >= eye_.pipeline.stereo.min_inliers;
      }
  }
  return cells;
}

std::vector<SpotRun> ViewsWorld::spots() const {
  constexpr int kLooks = 30;
  world::WorldParams slow = world_;
  slow.change = {.poster_share = 0.08,
                 .furniture_share = 0.1,
                 .door_share = 0,
                 .sudden_sessions = "8",
                 .sudden_share = 0.95,
                 .days = 1,
                 .people = 0,
                 .light = false};
  const world::World world = world::World::preset(params_.lifelong_building, slow);
  std::vector<Spot> appearances;  // the last one after the abrupt change
  for (int session = 1; session <= 8; ++session)
    appearances.emplace_back(world, world.appearance(session), lifelongEye_.eyes, lifelongEye_.pipeline);
  const Pose2 pose = straightPoses(world.route(), 1).front();
  const auto budget = [this] {
    upkeep::UpkeepParams upkeep = pipeline_.upkeep;
    upkeep.max_views = params_.lifelong_views;
    return upkeep.budget(pipeline_.stereo.min_inliers);
  }();

  std::vector<SpotRun> runs;
  for (const EnvironmentClass& kind : environmentClasses(kLooks)) {
    SpotRun run{kind.name, kind.about, kLooks, {}, 0};
    base::Rng rng = base::Rng(world_.seed).fork(70);
    std::vector<upkeep::LruView> kept;
    std::map<base::PlaceId, types::Features> seen;
    for (int look = 0; look < kLooks; ++look) {
      const int which = kind.appearance(look);
      const Spot& spot = appearances[static_cast<std::size_t>(which < 0 ? 7 : which)];
      const Pose2 near = compose(pose, Pose2{rng.normal(0, 0.03), rng.normal(0, 0.03), rng.normal(0, 0.015)});
      std::vector<world::Pillar> people;
      if (kind.blocked(look)) people = somebodyBefore(world, near);
      const base::PlaceId id(static_cast<std::uint32_t>(look));
      seen[id] = spot.look(near, 5000 + 2 * static_cast<std::uint64_t>(look), people);
      upkeep::LruView added{id, static_cast<double>(look)};
      std::vector<base::PlaceId> ids;
      for (const auto& view : kept) ids.push_back(view.id);
      ids.push_back(id);
      const auto n = static_cast<Eigen::Index>(ids.size());
      Eigen::MatrixXd closeness = Eigen::MatrixXd::Zero(n, n);
      for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < i; ++j) {
          const auto &a = seen[ids[static_cast<std::size_t>(i)]], &b = seen[ids[static_cast<std::size_t>(j)]];
          closeness(i, j) = closeness(j, i) =
              upkeep::closeness(static_cast<int>(std::min(a.size(), b.size())),
                                inliersOf(a, b, lifelongEye_.pipeline, spot.camera().model));
        }
      for (Eigen::Index j = 0; j + 1 < n; ++j)
        if (closeness(n - 1, j) <= budget.rule.tau) {
          ++run.matched;
          break;
        }
      kept = upkeep::planDeletion(kept, added, closeness, budget.rule).kept;
      run.views.push_back(static_cast<int>(kept.size()));
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

}  // namespace engram::apps
