// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "slam_program.h"

#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/progress.h"
#include "engram/exporters/exporters.h"
#include "engram/exporters/html_report.h"
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
  return "  engram-slam config/fsh_omni.ini --rawlog day1.rawlog --map office.engram\n"
         "  engram-slam config/fsh_omni.ini --rawlog day2.rawlog --map office.engram --extend\n"
         "  engram-slam config/fsh_mono.ini --rawlog walk.rawlog --set extractor.extractor=akaze\n"
         "  engram-slam robot.ini --live front --map office.engram --record today.rawlog --stream "
         "/tmp/engram\n"
         "  engram-slam config/fsh_omni.ini --dump-config\n";
}

void SlamProgram::declare(CLI::App& app) {
  config_.declare(app);
  input_.declare(app);
  app.add_option("--map", map_, "Map file to write (default: the rawlog's name with .engram)");
  const auto overwrite = app.add_flag("--overwrite", overwrite_, "Replace an existing map");
  app.add_flag("--extend", extend_, "Go on with an existing map: wake up in it, update and enlarge it")
      ->excludes(overwrite);
  app.add_option("--report", report_,
                 "Folder for summary, scene, graph, trajectory and the record of every image");
  app.add_option("--truth", truth_, "Ground truth, to count false closures and measure the trajectory");
  app.add_option("--truth-radius", truthRadius_,
                 "A closure over more than this is false, with TUM truth [m]");
  app.add_option("--truth-margin", truthMargin_, "Widens the truth by so many images or links");
  stream_.declare(app);
  window_.declare(app);
  app.add_option("--json", json_, "File for the final figures");
  app.add_flag("-q,--quiet", quiet_, "No progress, no summary");
}

std::string SlamProgram::mapPath() const {
  if (map_.empty() && input_.rawlog().empty()) throw base::Error("--live needs --map: the file for the map");
  return map_.empty() ? fs::path(input_.rawlog()).replace_extension(".engram").string() : map_;
}

int SlamProgram::run(std::ostream& out, std::ostream& err) {
  if (config_.load(out)) return kOk;
  if (!input_.given(config_))
    throw base::Error("--rawlog or --live is missing: which images shall be mapped?");
  const std::string path = mapPath();
  if (!extend_ && !overwrite_ && fs::exists(path))
    throw base::Error(path + " exists; give --overwrite to replace it or --extend to go on with it");
  requireFolderOf(json_);
  makeFolder(report_);

  std::optional<MapTruth> truth;
  if (!truth_.empty()) truth.emplace(truth_, evaluation::TruthOptions{truthMargin_, truthRadius_, 1.0});
  std::optional<store::MapFile> file;
  if (extend_) file = store::MapFile::open(path, store::Access::kReadOnly);
  map::TopologicalMap known;
  if (file) known = file->load();
  map::Cursor stored = known.now();
  const int keep = config_.pipeline.upkeep.keep_drives;
  if (keep > 0) known.forgetPath(known.nextSession() - keep);
  pipeline::Pipeline mapper(config_.pipeline, std::move(known));
  if (file) {
    store::requireCompatible(file->header(), mapper.header(), path);
    file.reset();  // a map that is refused keeps every byte
    file = store::MapFile::open(path, store::Access::kReadWrite);
    if (keep > 0 && !mapper.map().path().empty()) file->forgetRecords(mapper.map().path().front().stamp);
  }
  stream_.open(path);
  window_.open(config_.pipeline, path, err);
  input_.open(config_, err);

  SlamFigures figures;
  base::Progress progress(quiet_ ? nullptr : &err, "mapping");
  while (const auto frame = input_.next()) {
    types::FrameReport report = mapper.process(*frame);
    input_.annotate(report);
    stream_.sendMapped(report, *frame, mapper.map());
    if (truth) truth->survey(mapper, report);
    if (!file) file = createMap(path, mapper, *frame);
    file->commit(mapper.map(), mapper.map().changesSince(stored), &report);
    figures.add(report, mapper.map(), truth ? &*truth : nullptr);
    window_.after(*frame, report, mapper.map());
    progress.update(input_.progress(), static_cast<std::size_t>(figures.images()));
  }
  progress.finish();
  if (figures.images() == 0) {
    if (base::interrupted()) return kPartial;
    throw base::Error(input_.problem().empty() ? "no images" : input_.problem());
  }
  mapper.finish();
  file->commit(mapper.map(), mapper.map().changesSince(stored));
  return conclude(*file, mapper, figures, truth ? &*truth : nullptr, out, err);
}

store::MapFile SlamProgram::createMap(const std::string& path, const pipeline::Pipeline& mapper,
                                      const types::Frame& first) {
  map::MapHeader header = mapper.header();
  header.parameters = config_.dumpForMap();
  header.firstStamp = first.stamp;
  return store::MapFile::create(path, header, overwrite_);
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
  const auto bytes = fs::file_size(file.path());
  auto json = figures.toJson(map, bytes, peakResidentBytes());
  json["live"] = input_.figures();
  writeJson(json_, json);
  std::ostream& summary = stream_.summaryTo(out, err);
  if (!quiet_) {
    figures.print(summary, map, file.path(), bytes);
    summary << input_.summary();
  }

  const std::string problem = input_.problem();
  if (!problem.empty()) err << name() << ": " << problem << "\n";
  if (base::interrupted()) err << name() << ": interrupted; the map holds every image up to here\n";
  return input_.exitCode();
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
  base::writeText((folder / "images.jsonl").string(), lines, true);
  base::writeText((folder / "index.html").string(), exporters::toHtml(page), true);
  exporters::writeScene((folder / "map.3Dscene").string(), map, {.images = true, .overwrite = true});
  exporters::writeGraph((folder / "map.graph").string(), map, true);
  exporters::writeTum((folder / "trajectory.tum").string(), map, true);
}

}  // namespace engram::apps
