// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "views/views_world.h"

#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/base/progress.h"
#include "engram/base/rng.h"
#include "engram/base/text.h"
#include "engram/cameras/stereo_rig.h"
#include "engram/vocabulary/vocabulary_tree.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <sstream>

namespace engram::apps {

namespace {

std::vector<std::string> listOf(const std::string& text) {
  std::vector<std::string> items;
  std::istringstream in(text);
  for (std::string item; std::getline(in, item, ',');) items.push_back(item);
  return items;
}

/// Orders the sequences at random, the same way for the same seed.
std::vector<int> shuffled(int n, base::Rng rng) {
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  for (int i = n - 1; i > 0; --i) std::swap(order[static_cast<std::size_t>(i)], order[rng.below(i + 1)]);
  return order;
}

}  // namespace

void ViewsWorldParams::describe(base::Params& p) {
  p.add("building", building, "preset of the sequences and of the repair");
  p.add("sequences", sequences, "drives that are stitched to one map", {1, 20});
  p.add("orders", orders, "random orders in which they are stitched as well", {0, 100});
  p.add("wheels", wheels, "the drives have wheel odometry as well; the repair drive never has");
  p.add("covers", covers, "times that both eyes are covered in the repair drive", {0, 1000});
  p.add("cover_length", cover_length, "way that a cover lasts [m]", {0.1, 100});
  p.add("lifelong_building", lifelong_building, "preset of the lifelong run, of kappa and of the rates");
  p.add("sessions", sessions, "drives of the lifelong run", {1, 500});
  p.add("sudden", sudden, "drives of it before which much changes at once, such as 15,30; empty: none");
  p.add("lifelong_views", lifelong_views, "kappa of the lifelong run", {1, 1000});
  p.add("kappas", kappas, "values of kappa that are compared, such as 2,5,10");
  p.add("kappa_sessions", kappa_sessions, "drives of that comparison", {1, 500});
  p.add("poses", poses, "reference poses of the recognition rate over distance and angle", {1, 1000});
  p.add("false_distance", false_distance, "a link whose pose is so far from the truth is false [m]",
        {0.01, 10});
  p.addDegrees("false_angle", false_angle, "or whose direction is [deg]", {0.1, 180});
  p.add("right_within", right_within, "an image is located right when its place is this near [m]", {0.1, 10});
  p.add("locate_every", locate_every, "way between the images that are located [m]", {0.01, 10});
  p.add("sequence_scale", sequence_scale, "size of the images of the sequences, of those of the camera",
        {0.1, 1});
  p.add("lifelong_scale", lifelong_scale, "the same of the lifelong run, of kappa and of the spots",
        {0.1, 1});
}

/// K's sequences start and end anywhere; the first is a whole round.
ShownDrive sequenceOf(const KeptDrive& drive, int number, bool wheels) {
  static const std::vector<std::pair<double, double>> windows{{0, 1},   {0.3, 1},     {0, 0.7},
                                                              {0.5, 1}, {0.15, 0.85}, {0, 1}};
  const auto& [from, to] = windows[static_cast<std::size_t>(number) % windows.size()];
  return {&drive, from, to, wheels, {}};
}

std::vector<std::pair<std::size_t, std::size_t>> coversOf(const KeptDrive& drive, int covers, double length,
                                                          std::uint64_t seed) {
  std::vector<std::pair<std::size_t, std::size_t>> list;
  base::Rng rng = base::Rng(seed).fork(31);
  const auto& arcs = drive.arcs;
  for (int k = 0; k < covers; ++k) {
    // One in each of equal parts of the way: they never touch.
    const double part = (arcs.back() - arcs.front()) / covers;
    const double start =
        arcs.front() + part * k + rng.uniform() * std::max(0.0, part - length) * 0.8 + 0.1 * part;
    const auto at = [&](double arc) {
      return static_cast<std::size_t>(std::lower_bound(arcs.begin(), arcs.end(), arc) - arcs.begin());
    };
    list.emplace_back(at(start), std::max(at(start) + 2, at(start + std::min(length, 0.7 * part))));
  }
  return list;
}

ViewsWorld::ViewsWorld(const ViewsWorldParams& params, const world::WorldParams& world,
                       const pipeline::PipelineParams& pipeline, Workplace place)
    : params_(params), world_(world), pipeline_(pipeline), place_(std::move(place)) {
  base::validate(params_);
}

ViewsWorld::Eye ViewsWorld::makeEye(double scale, const std::string& name) const {
  Eye eye{world::presetEyes("stereo"), pipeline_};
  if (!pipeline_.camera.file.empty()) {
    auto [left, right] = cameras::loadStereoRig(pipeline_.camera.file);
    eye.eyes = {pipeline_.camera.file, left, right};
  }
  const auto smaller = [scale](const cameras::CameraRig& rig) {
    cameras::CameraRig small = cameras::makeRig(rig.camera->scaled(scale, scale));
    small.T_robot_cam = rig.T_robot_cam;
    return small;
  };
  if (scale != 1) {
    eye.eyes.left = smaller(eye.eyes.left);
    eye.eyes.right = smaller(*eye.eyes.right);
  }
  eye.pipeline.camera.file = place_.file(name);
  base::writeText(eye.pipeline.camera.file,
                  cameras::toText(cameras::StereoRig{eye.eyes.left, *eye.eyes.right}), true);
  return eye;
}

std::vector<KeptDrive> ViewsWorld::keep(const world::World& world, const Eye& eye, int sessions,
                                        const std::string& name) const {
  base::Progress progress(place_.progress, name + " drives");
  std::vector<KeptDrive> drives;
  for (int k = 0; k < sessions; ++k)
    drives.push_back(keepDrive(
        world, eye.eyes, k + 1, place_.file("drives/" + name + "_" + std::to_string(k + 1)), place_.threads,
        [&](double share) { progress.update((k + share) / sessions, static_cast<std::size_t>(k)); }));
  return drives;
}

OrderedRun ViewsWorld::mapInOrder(const std::vector<int>& order, const std::string& name) const {
  OrderedRun run{.order = order, .sessions = {}};
  ViewMapping mapping(eye_.pipeline, place_.file("maps/" + name + ".engram"), params_.false_distance,
                      params_.false_angle);
  for (const int k : order)
    run.sessions.push_back(mapping.add(sequenceOf(drives_[static_cast<std::size_t>(k)], k, params_.wheels)));
  run.ate = mapping.ate();
  run.apart = mapping.apart();
  run.length = mapping.length();
  return run;
}

/// The map of all sequences, days later, with moved furniture and covered eyes (K-36).
RepairRun ViewsWorld::repair() const {
  RepairRun run;
  ViewMapping mapping(eye_.pipeline, place_.file("maps/repaired.engram"), params_.false_distance,
                      params_.false_angle);
  for (int k = 0; k < params_.sequences; ++k)
    mapping.add(sequenceOf(drives_[static_cast<std::size_t>(k)], k, params_.wheels));
  const KeptDrive& changed = drives_[drives_.size() - 2];
  const ShownDrive test{&drives_.back(), 0, 1, false, {}};
  run.before = locateEach(mapping.map(), test, eye_.pipeline, params_.locate_every, params_.right_within);
  const std::uint32_t firstEdge = mapping.map().content().nextEdge;
  run.covers = coversOf(changed, params_.covers, params_.cover_length, world_.seed);
  run.session = mapping.add({&changed, 0, 1, false, run.covers});
  for (const auto& [id, edge] : mapping.map().edges()) {
    if (id.value < firstEdge) continue;
    run.linksWithin += edge.type == map::EdgeType::kLoop;
    run.linksAcross += edge.type == map::EdgeType::kRecognition;
  }
  run.after = locateEach(mapping.map(), test, eye_.pipeline, params_.locate_every, params_.right_within);
  return run;
}

/// Trained once, on the first drive of the lifelong run.
std::string ViewsWorld::trainVocabulary() const {
  const std::string file = place_.file("vocabulary.engramtree");
  ViewMapping mapping(lifelongEye_.pipeline, place_.file("maps/first.engram"), params_.false_distance,
                      params_.false_angle);
  mapping.add({&lifelongDrives_.front(), 0, 1, params_.wheels, {}});
  std::vector<const types::Descriptors*> images;
  for (const auto& [id, place] : mapping.map().places())
    images.push_back(&place.memory->features.descriptors);
  vocabulary::VocabularyTree::train(images, pipeline_.tree).save(file, true);
  return file;
}

LifelongRun ViewsWorld::live(const std::string& name, const std::string& rule, int sessions,
                             const std::string& vocabulary) const {
  pipeline::PipelineParams params = lifelongEye_.pipeline;
  params.views.vocabulary = vocabulary;
  params.upkeep.upkeep = rule == "none" ? "none" : "lru_views";
  if (rule != "none") params.upkeep.max_views = std::stoi(rule);
  LifelongRun run{rule, {}, {}, 0};
  ViewMapping mapping(params, place_.file("maps/" + name + ".engram"), params_.false_distance,
                      params_.false_angle);
  for (int k = 0; k < sessions; ++k) {
    const ShownDrive shown{&lifelongDrives_[static_cast<std::size_t>(k)], 0, 1, params_.wheels, {}};
    run.located.push_back(
        k > 0 ? locateEach(mapping.map(), shown, params, params_.locate_every, params_.right_within)
              : LocatedShare{});
    run.sessions.push_back(mapping.add(shown));
  }
  run.ate = mapping.ate();
  return run;
}

ViewsResult ViewsWorld::run() {
  const auto kappas = listOf(params_.kappas);
  for (const std::string& kappa : kappas)
    if (kappa.empty() || kappa.find_first_not_of("0123456789") != std::string::npos || std::stoi(kappa) < 1)
      throw base::ConfigError("[views_world] kappas: " + base::quoted(kappa) +
                              " is no whole number from 1 on");
  for (const char* folder : {"drives", "maps"}) place_.subfolder(folder);
  eye_ = makeEye(params_.sequence_scale, "camera.ini");
  lifelongEye_ = makeEye(params_.lifelong_scale, "camera_lifelong.ini");
  world::WorldParams days = world_;  // of the sequences: two days, then a changed building
  days.change.days = 0.3;
  days.change.poster_share = 0.02;
  days.change.furniture_share = 0.05;
  days.change.door_share = 0.1;
  days.change.sudden_sessions = std::to_string(params_.sequences + 1);
  building_ = std::make_unique<world::World>(world::World::preset(params_.building, days));
  world::WorldParams months = world_;
  months.change.sudden_sessions = params_.sudden;
  lifelongBuilding_ = std::make_unique<world::World>(world::World::preset(params_.lifelong_building, months));
  drives_ = keep(*building_, eye_, params_.sequences + 2, params_.building);
  lifelongDrives_ =
      keep(*lifelongBuilding_, lifelongEye_, std::max(params_.sessions, params_.kappa_sessions), "lifelong");

  ViewsResult result;
  result.tour = drives_.front().lap;
  result.orders.resize(static_cast<std::size_t>(params_.orders) + 1);
  result.lifelong.resize(2);
  result.kappas.resize(kappas.size());
  const std::string vocabulary = trainVocabulary();
  std::vector<std::function<void()>> jobs;  // the longest first
  jobs.emplace_back(
      [&] { result.lifelong[0] = live("lifelong_none", "none", params_.sessions, vocabulary); });
  jobs.emplace_back([&] {
    result.lifelong[1] =
        live("lifelong_lru", std::to_string(params_.lifelong_views), params_.sessions, vocabulary);
  });
  jobs.emplace_back([&] { result.repair = repair(); });
  for (std::size_t k = 0; k < result.orders.size(); ++k)
    jobs.emplace_back([&, k] {
      std::vector<int> order(static_cast<std::size_t>(params_.sequences));
      std::iota(order.begin(), order.end(), 0);
      if (k > 0) order = shuffled(params_.sequences, base::Rng(world_.seed).fork(40 + k));
      result.orders[k] = mapInOrder(order, "order_" + std::to_string(k));
    });
  for (std::size_t k = 0; k < kappas.size(); ++k)
    jobs.emplace_back([&, k] {
      result.kappas[k] = live("kappa_" + kappas[k], kappas[k], params_.kappa_sessions, vocabulary);
    });
  jobs.emplace_back([&] { result.offsets = offsets(); });
  jobs.emplace_back([&] { result.spots = spots(); });

  runJobs(place_, jobs);
  return result;
}

}  // namespace engram::apps
