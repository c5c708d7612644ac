// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "data_set.h"

#include "engram/apps/json_file.h"
#include "engram/apps/program.h"
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/parallel.h"
#include "engram/base/progress.h"
#include "engram/cameras/stereo_rig.h"
#include "plan_picture.h"

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <sstream>

namespace engram::apps {
namespace {

namespace fs = std::filesystem;

std::string truthText(const world::Session& session) {
  std::ostringstream out;
  out << "# T_world_robot of every image: stamp [s] x y z [m] qx qy qz qw\n";
  for (std::size_t i = 0; i < session.size(); ++i) {
    const Eigen::Isometry3d T = session.T_world_robot(i);
    const Eigen::Quaterniond q(T.rotation());
    char line[192];
    std::snprintf(line, sizeof line, "%.6f %.6f %.6f %.6f %.9f %.9f %.9f %.9f\n", session.stamp(i),
                  T.translation().x(), T.translation().y(), T.translation().z(), q.x(), q.y(), q.z(), q.w());
    out << line;
  }
  return out.str();
}

std::string placesText(const world::Session& session) {
  std::ostringstream out;
  out << "image,stamp,place,x,y,heading_deg\n";
  for (std::size_t i = 0; i < session.size(); ++i) {
    const auto p = session.drive().poseAt(session.drive().imageTimes()[i]);
    char line[160];
    std::snprintf(line, sizeof line, "%zu,%.6f,%d,%.4f,%.4f,%.3f\n", i, session.stamp(i), session.place(i),
                  p.x, p.y, p.heading * 57.29577951308232);
    out << line;
  }
  return out.str();
}

nlohmann::json describe(const world::Session& session, const std::string& name, const char* kind) {
  const auto& a = session.appearance();
  return {{"name", name},
          {"kind", kind},
          {"number", a.session},
          {"words", a.inWords()},
          {"day", a.day},
          {"hour", a.hour},
          {"season", a.season},
          {"cloud", a.cloud},
          {"sun_elevation_deg", std::asin(a.toSun.z()) * 57.29577951308232},
          {"people", a.people},
          {"changed_posters", a.changedPosters},
          {"posters", a.posters.size()},
          {"moved_furniture", a.movedFurniture},
          {"furniture", a.furniture.size()},
          {"changed_doors", a.changedDoors},
          {"doors", a.doorOpen.size()},
          {"images", session.size()},
          {"start_stamp", session.startStamp()}};
}

// All names this call will write, so that nothing is begun when something is in the way.
std::vector<std::string> targets(const DataSetOptions& o) {
  std::vector<std::string> names{"camera.ini", "world.json", "plan.png", "plan.txt"};
  for (int n = 1; n <= o.sessions + (o.testDrive ? 1 : 0); ++n) {
    char stem[32] = "test";
    if (n <= o.sessions) std::snprintf(stem, sizeof stem, "session_%02d", n);
    for (const char* end : {".rawlog", ".truth.tum", ".places.csv"}) names.push_back(std::string(stem) + end);
    if (o.externalImages) names.push_back(std::string(stem) + "_Images");
  }
  return names;
}

void prepareFolder(const DataSetOptions& o) {
  makeFolder(o.folder);
  for (const auto& name : targets(o)) {
    const fs::path target = fs::path(o.folder) / name;
    if (!o.overwrite && fs::exists(target))
      throw base::Error(target.string() + ": exists already; choose another --out or add --overwrite");
    const bool isFolder = name.ends_with("_Images");
    if (!isFolder) base::requireWritable(target.string());
    if (isFolder && fs::exists(target) && !fs::is_directory(target))
      throw base::Error(target.string() + ": is no folder; the images are to go there");
  }
}

class Maker {
 public:
  Maker(const world::World& world, const world::Eyes& eyes, const DataSetOptions& options, std::ostream& err)
      : world_(world), eyes_(eyes), o_(options), progress_(options.quiet ? nullptr : &err, "rendering") {}

  DataSetFigures run() {
    const auto start = std::chrono::steady_clock::now();
    prepareFolder(o_);
    writeCamera();
    writePlan();
    const int all = o_.sessions + (o_.testDrive ? 1 : 0);
    for (int n = 1; n <= all && !figures_.stopped; ++n) {
      char stem[32] = "test";
      if (n <= o_.sessions) std::snprintf(stem, sizeof stem, "session_%02d", n);
      makeSession(n, stem, n <= o_.sessions ? world::DriveKind::kTour : world::DriveKind::kTest, all);
    }
    progress_.finish();
    base::writeText(file("world.json"), toText(worldJson(), 2) + "\n", true);
    figures_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (figures_.images > 0) figures_.msPerFrame = 1000 * busy_ / static_cast<double>(figures_.images);
    return figures_;
  }

 private:
  std::string file(const std::string& name) const { return (fs::path(o_.folder) / name).string(); }

  void writeCamera() {
    const auto text = eyes_.right ? cameras::toText(cameras::StereoRig{eyes_.left, *eyes_.right})
                                  : cameras::toText(eyes_.left);
    base::writeText(file("camera.ini"), text, true);
  }

  void writePlan() {
    std::vector<unsigned char> png;
    cv::imencode(".png", drawPlan(world_, world_.appearance(1)), png);
    base::writeText(file("plan.png"), std::string(png.begin(), png.end()), true);
    base::writeText(file("plan.txt"), world_.plan().toText(), true);
  }

  void makeSession(int number, const std::string& stem, world::DriveKind kind, int all) {
    const world::Session session(world_, number, eyes_, kind, o_.threads);
    RawlogFile rawlog(file(stem + ".rawlog"), session, o_.layout, o_.externalImages);
    const auto start = std::chrono::steady_clock::now();
    // Frames are independent: a block of them at a time, each on one thread.
    const auto block = static_cast<std::size_t>(std::max(1, o_.threads)) * 4;
    std::vector<types::Frame> frames(block);
    for (std::size_t first = 0; first < session.size(); first += block) {
      if (base::interrupted()) {
        figures_.stopped = true;
        return;  // the half rawlog disappears
      }
      const std::size_t n = std::min(block, session.size() - first);
      base::parallelFor(n, o_.threads, [&](std::size_t k) { frames[k] = session.frame(first + k); });
      for (std::size_t k = 0; k < n; ++k) rawlog.add(first + k, frames[k]);
      const double share = static_cast<double>(first + n) / static_cast<double>(session.size());
      progress_.update((number - 1 + share) / all, figures_.images + first + n);
    }
    base::writeText(file(stem + ".truth.tum"), truthText(session), true);
    base::writeText(file(stem + ".places.csv"), placesText(session), true);
    rawlog.close();
    busy_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    figures_.images += session.size();
    ++figures_.sessions;
    sessions_.push_back(describe(session, stem, kind == world::DriveKind::kTour ? "tour" : "test"));
  }

  nlohmann::json worldJson() const {
    const auto& route = world_.route();
    nlohmann::json stations = nlohmann::json::array();
    for (int k = 0; k < route.stations(); ++k) {
      const auto p = route.at(k * route.pitch());
      stations.push_back(
          {{"place", k}, {"x", p.x}, {"y", p.y}, {"heading_deg", p.heading * 57.29577951308232}});
    }
    return {{"format", "engram-world 1"},    {"seed", world_.params().seed}, {"preset", o_.preset},
            {"camera", eyes_.name},          {"route_m", route.length()},    {"places", route.stations()},
            {"complete", !figures_.stopped}, {"sessions", sessions_},        {"stations", stations}};
  }

  const world::World& world_;
  const world::Eyes& eyes_;
  const DataSetOptions& o_;
  base::Progress progress_;  // one for all drives: its clock runs on
  DataSetFigures figures_;
  double busy_ = 0;
  nlohmann::json sessions_ = nlohmann::json::array();
};

}  // namespace

DataSetFigures makeDataSet(const world::World& world, const world::Eyes& eyes, const DataSetOptions& options,
                           std::ostream& err) {
  return Maker(world, eyes, options, err).run();
}

}  // namespace engram::apps
