// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/kept_drive.h"

#include "engram/apps/json_file.h"
#include "engram/base/atomic_file.h"
#include "engram/base/config.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/parallel.h"
#include "engram/sources/rawlog_source.h"
#include "engram/sources/rawlog_writer.h"

#include <algorithm>
#include <sstream>

namespace engram::apps {
namespace {

using nlohmann::json;

constexpr int kJpegQuality = 95;

/// Everything that a drive depends on, as text.
std::string describe(const world::World& world, const world::Eyes& eyes, int session) {
  world::WorldParams params = world.params();
  base::Config config;
  config.bind("change", params.change);
  config.bind("drive", params.drive);
  config.bind("sensor", params.sensor);
  std::ostringstream text;
  text << config.dump() << world.plan().toText() << cameras::toText(eyes.left) << "seed " << params.seed
       << ", session " << session;
  return text.str();
}

void render(const world::Session& day, const std::string& stem, int threads,
            const std::function<void(double)>& progress) {
  sources::RawlogWriterParams params;
  params.jpeg_quality = kJpegQuality;
  params.overwrite = true;
  sources::RawlogWriter rawlog(stem + ".rawlog", params);
  const auto block = static_cast<std::size_t>(std::max(1, threads)) * 4;
  std::vector<types::Frame> frames(block);
  for (std::size_t first = 0; first < day.size(); first += block) {
    if (base::interrupted()) throw base::Interrupted("rendering " + stem);
    const std::size_t n = std::min(block, day.size() - first);
    base::parallelFor(n, threads, [&](std::size_t k) { frames[k] = day.frame(first + k); });
    for (std::size_t k = 0; k < n; ++k) rawlog.add(frames[k]);
    progress(static_cast<double>(first + n) / static_cast<double>(day.size()));
  }
  rawlog.close();
}

void record(const world::World& world, const world::Session& day, const std::string& stem,
            const std::string& madeWith) {
  evaluation::Trajectory truth;
  json arcs = json::array();
  for (std::size_t i = 0; i < day.size(); ++i) {
    truth.push_back({day.stamp(i), day.T_world_robot(i)});
    arcs.push_back(day.drive().arcLengthAt(day.drive().imageTimes()[i]));
  }
  std::ostringstream tum;
  evaluation::writeTum(tum, truth);
  base::writeText(stem + ".truth.tum", tum.str(), true);
  // Last: a drive counts as kept from here on.
  base::writeText(stem + ".json",
                  toText(json{{"made_with", madeWith},
                              {"weather", day.appearance().inWords()},
                              {"lap_m", world.route().length()},
                              {"arcs_m", arcs}}),
                  true);
}

json readRecord(const std::string& stem) { return readJsonIfAny(stem + ".json"); }

}  // namespace

KeptDrive keepDrive(const world::World& world, const world::Eyes& eyes, int session, const std::string& stem,
                    int threads, const std::function<void(double)>& progress) {
  const std::string madeWith = describe(world, eyes, session);
  json kept = readRecord(stem);
  if (!kept.is_object() || kept.value("made_with", std::string()) != madeWith) {
    const world::Session day(world, session, eyes, world::DriveKind::kTour, threads);
    render(day, stem, threads, progress);
    record(world, day, stem, madeWith);
    kept = readRecord(stem);
  }
  KeptDrive drive;
  drive.rawlog = stem + ".rawlog";
  drive.weather = kept.at("weather").get<std::string>();
  drive.lap = kept.at("lap_m").get<double>();
  drive.truth = evaluation::readTum(stem + ".truth.tum");
  drive.arcs = kept.at("arcs_m").get<std::vector<double>>();
  return drive;
}

void KeptDrive::forEachFrame(const std::function<void(const types::Frame&)>& see) const {
  const auto source = sources::openRawlog(rawlog);
  while (const auto frame = source->next()) {
    if (base::interrupted()) throw base::Interrupted("reading " + rawlog);
    see(*frame);
  }
  if (source->whole() && source->stats().images == arcs.size()) return;
  throw base::Error(rawlog + " is damaged: remove it and " + rawlog.substr(0, rawlog.size() - 7) +
                    ".json, and start again");
}

std::size_t KeptDrive::firstLapImages() const {
  return static_cast<std::size_t>(
      std::count_if(arcs.begin(), arcs.end(), [&](double arc) { return arc < lap; }));
}

}  // namespace engram::apps
