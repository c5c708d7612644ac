// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "slam_program.h"

#include "engram/apps/checks.h"
#include "engram/apps/map_parameters.h"
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/progress.h"
#include "engram/base/text.h"
#include "engram/exporters/exporters.h"
#include "engram/exporters/html_report.h"
#include "engram/keeper/closures.h"
#include "engram/store/map_copy.h"
#include "engram/store/report_json.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <ostream>

namespace engram::apps {
namespace fs = std::filesystem;

std::string SlamProgram::description() const {
  return "Builds a topological map that remembers and forgets, or extends one, from the images of a rawlog "
         "or of a live camera.";
}

std::string SlamProgram::examples() const {
  return "  engram-slam fsh_omni --rawlog day1.rawlog --map office.engram\n"
         "  engram-slam --rawlog day2.rawlog --map office.engram --extend\n"
         "  engram-slam --rawlog day2.rawlog --map office.engram --extend --resume\n"
         "  engram-slam fsh_mono --images photos --map walk.engram\n"
         "  engram-slam fsh_mono --video walk.mp4 --every 10 --camera left.yaml\n"
         "  engram-slam robot.ini --live front --map office.engram --record today.rawlog --stream "
         "/tmp/engram\n"
         "  engram-slam fsh_omni --dump-config\n";
}

void SlamProgram::declare(CLI::App& app) {
  config_.declare(app);
  input_.declare(app);
  app.add_option("--map", map_, "Map file to write (default: the rawlog's name with .engram)");
  const auto overwrite = app.add_flag("--overwrite", drive_.overwrite, "Replace an existing map");
  app.add_flag("--extend", drive_.extend, "Go on with an existing map: wake up in it, update and enlarge it")
      ->excludes(overwrite);
  app.add_flag(
         "--resume", drive_.resume,
         "Finish a drive that was cut off: given beside the options of the first time, it ends with the "
         "same map")
      ->excludes(overwrite);
  app.add_flag("--again", drive_.again, "With --extend: learn a rawlog that the map has learnt before");
  app.add_flag(
      "--accept-parameters", acceptParameters_,
      "With --extend: go on though the map was made with other parameters of memory, words or appearance; "
      "the map notes it");
  app.add_option("--report", report_,
                 "Folder for summary, scene, graph, trajectory and the record of every image");
  app.add_option("--truth", truth_, "Ground truth, to count false closures and measure the trajectory");
  app.add_option("--truth-radius", truthRadius_, "A closure over more than this is false, with TUM truth [m]")
      ->check(positive());
  app.add_option("--truth-margin", truthMargin_, "Widens the truth by so many images or links")
      ->check(wholeFrom(0));
  stream_.declare(app);
  window_.declare(app);
  app.add_option("--json", json_, "File for the final figures");
  app.add_flag("-q,--quiet", quiet_, "No progress, no summary");
}

std::string SlamProgram::mapPath() const {
  if (!map_.empty()) return map_;
  if (!input_.given(config_))
    throw UsageError("--rawlog, --images, --video or --live is missing: which images?");
  if (input_.path().empty()) throw UsageError("--live needs --map: the file for the map");
  fs::path images = input_.path();
  if (!images.has_filename()) images = images.parent_path();
  return images.replace_extension(".engram").string();
}

int SlamProgram::run(std::ostream& out, std::ostream& err) {
  const bool mapHasConfig = drive_.extend && config_.options.file.empty();
  if (config_.load(out, mapHasConfig ? mapPath() : "")) return kOk;
  if (!input_.given(config_))
    throw UsageError("--rawlog, --images, --video or --live is missing: which images shall be mapped?");
  say(config_.warning(), err);
  const std::string path = mapPath();
  base::requireWritable(json_);
  makeFolder(report_, {"images.jsonl", "index.html", "map.3Dscene", "map.graph", "trajectory.tum"});

  std::optional<MapTruth> truth;
  if (!truth_.empty()) truth.emplace(truth_, evaluation::TruthOptions{truthMargin_, truthRadius_, 1.0});
  store::DriveWriter drive = openMap(path, err);
  if (drive.complete()) {
    if (!quiet_) out << path << ": holds the whole drive already; nothing to resume\n";
    return kOk;
  }
  map::TopologicalMap known = drive.load();
  const int keep = config_.pipeline.upkeep.keep_drives;
  const int firstKept = keep > 0 ? known.nextSession() - keep : 0;
  known.forgetPath(firstKept);
  if (config_.liveSection.empty())
    input_.open(config_, err);  // tells the calibration; a live camera starts last
  pipeline::Pipeline mapper(config_.pipeline, std::move(known));
  if (drive.header() != nullptr) {
    store::requireCompatible(*drive.header(), mapper.header(), path);
    const auto changes = parameterChanges(drive.header()->parameters, config_.dumpForMap());
    const std::string accepted = acceptedChanges(changes, acceptParameters_, path);
    if (!accepted.empty()) drive.note("with " + accepted);
    const keeper::Rejections rejected = keeper::rejectionsOf(drive.file().notes());
    mapper.keepApart({rejected.begin(), rejected.end()});
  }
  if (keep > 0) drive.forget(mapper.map(), firstKept);
  stream_.open(path, err);
  window_.open(config_.pipeline, path, err);
  input_.open(config_, err);

  SlamFigures figures;
  base::Progress progress(quiet_ ? nullptr : &err, "mapping");
  while (const auto frame = input_.next()) {
    if (figures.images() == 0) drive.begin(*frame, mapper.session(), headerFor(mapper, *frame));
    types::FrameReport report = mapper.process(*frame);
    input_.annotate(report);
    if (truth) truth->survey(mapper, report);
    drive.add(mapper.map(), report);
    if (!drive.replayed()) stream_.sendMapped(report, *frame, mapper.map());
    say(eyes_.after(mapper.eyes()), err);
    figures.add(report, mapper.map(), truth ? &*truth : nullptr);
    if (!report_.empty()) pictures_.add(report, *frame);
    window_.after(*frame, report, mapper.map());
    progress.update(input_.progress(), static_cast<std::size_t>(figures.images()));
  }
  progress.finish();
  if (figures.images() == 0) {
    if (base::interrupted()) return kPartial;
    throw base::Error(input_.problem().empty() ? "no images" : input_.problem());
  }
  say(eyes_.after(mapper.eyes(), true), err);
  figures.use().requireSome();
  mapper.finish();
  drive.end(mapper.map(), input_.exitCode() == kOk);
  drive.keep(mapper.derived());
  notice_ = drive.notice();
  return conclude(drive.file(), mapper, figures, truth ? &*truth : nullptr, out, err);
}

/// The images are opened first where a drive is to be resumed: the first one tells which it is.
store::DriveWriter SlamProgram::openMap(const std::string& path, std::ostream& err) {
  if (const std::string missing = store::missingLog(path); drive_.extend && !missing.empty())
    err << name() << ": warning: map '" << path << "': " << missing << "\n";
  if (!drive_.resume) return {path, drive_, input_.source(config_)};
  if (!config_.liveSection.empty())
    throw base::Error("--resume goes with --rawlog: what a live camera saw is gone, unless --record kept it");
  input_.open(config_, err);
  return {path, drive_, input_.source(config_), input_.peek()};
}

map::MapHeader SlamProgram::headerFor(const pipeline::Pipeline& mapper, const types::Frame& first) const {
  map::MapHeader header = mapper.header();
  header.parameters = config_.dumpForMap();
  header.firstStamp = first.stamp;
  return header;
}

int SlamProgram::conclude(store::MapFile& file, const pipeline::Pipeline& mapper, SlamFigures& figures,
                          const MapTruth* truth, std::ostream& out, std::ostream& err) {
  const map::TopologicalMap& map = mapper.map();
  if (truth && truth->hasPoses())
    figures.setTrajectoryError(trajectoryError(map, mapper.session(), truth->poses()));
  if (!report_.empty()) writeReport(file, map);
  file.close();
  input_.close();
  stream_.close(err);
  if (truth && !base::interrupted()) truth->requireMatch(map, err);
  const auto bytes = file.bytes();
  auto json = figures.toJson(map, bytes, peakResidentBytes());
  json["live"] = input_.figures();
  json["odometry"] = toJson(mapper.wheels());
  writeJson(json_, json);
  std::ostream& summary = stream_.summaryTo(out, err);
  if (!quiet_) {
    figures.print(summary, map, file.path(), bytes);
    summary << input_.summary();
  }

  const std::string problem = input_.problem();
  say(problem, err);
  if (base::interrupted()) err << name() << ": interrupted; the map holds every image up to here\n";
  say(figures.use().complaint(), err);
  say(pipeline::describe(mapper.wheels()), err);
  say(notice_, err);
  const bool sound = notice_.empty() && figures.use().complaint().empty() && !eyes_.faulty() &&
                     !pipeline::isGrave(mapper.wheels()) && !stream_.failed();
  return sound ? input_.exitCode() : kPartial;
}

/// Everything a person may want to open, in one folder.
void SlamProgram::writeReport(const store::MapFile& file, const map::TopologicalMap& map) const {
  const fs::path folder = report_;
  const std::vector<types::FrameReport> records = file.records();
  std::string lines;
  for (const auto& report : records) lines += store::toJson(report) + "\n";
  exporters::HtmlReport page;
  page.title = "Map " + fs::path(file.path()).filename().string();
  page.header = &file.header();
  page.map = &map;
  page.records = records;
  page.pictures = pictures_.all();
  base::writeText((folder / "images.jsonl").string(), lines, true);
  base::writeText((folder / "index.html").string(), exporters::toHtml(page), true);
  exporters::writeScene((folder / "map.3Dscene").string(), map, {.images = true, .overwrite = true});
  exporters::writeGraph((folder / "map.graph").string(), map, true);
  exporters::writeTum((folder / "trajectory.tum").string(), map, true);
}

}  // namespace engram::apps
