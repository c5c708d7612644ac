// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "localize_program.h"

#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/line_file.h"
#include "engram/base/progress.h"
#include "engram/pipeline/pipeline.h"
#include "engram/store/map_file.h"
#include "engram/store/report_json.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <ostream>

namespace engram::apps {
namespace fs = std::filesystem;

std::string LocalizeProgram::description() const {
  return "Says where the images of a rawlog or of a live camera were taken in a map. The map does not "
         "change, unless --adapt "
         "lets its places "
         "learn from what they are verified to look like.";
}

std::string LocalizeProgram::examples() const {
  return "  engram-localize config/fsh_omni.ini --map office.engram --rawlog day3.rawlog --out day3.csv\n"
         "  engram-localize config/fsh_omni.ini --map office.engram --rawlog day3.rawlog --adapt\n"
         "  engram-localize config/fsh_omni.ini --map office.engram --rawlog test.rawlog --truth "
         "test.truth.tum\n"
         "  engram-localize config/fsh_mono.ini --map left.engram --rawlog right.rawlog --truth truth.csv\n"
         "  engram-localize robot.ini --map office.engram --live front --stream /tmp/engram\n";
}

void LocalizeProgram::declare(CLI::App& app) {
  config_.declare(app);
  app.add_option("--map", map_, "Map made by engram-slam");
  input_.declare(app);
  app.add_flag("--adapt", adapt_, "Let recognised places learn; the map file is changed");
  app.add_flag("--global", global_,
               "Forget the belief before every image: global localisation of single images");
  app.add_option("--truth", truth_,
                 "Ground truth: query,first,last | image,matches | a,b links | TUM poses of this drive");
  app.add_option("--truth-margin", truthMargin_, "Widens the truth by so many images, links or places");
  app.add_option("--truth-radius", truthRadius_, "With TUM truth, places this near are right too [m]");
  app.add_option("--out", csv_, "File for one line an image (.csv)");
  app.add_option("--report", report_, "Folder for the record of every image and the summary");
  stream_.declare(app);
  window_.declare(app);
  app.add_option("--json", json_, "File for the final figures");
  app.add_flag("--overwrite", overwrite_, "Replace existing output files");
  app.add_flag("-q,--quiet", quiet_, "No progress, no summary");
}

int LocalizeProgram::run(std::ostream& out, std::ostream& err) {
  if (config_.load(out)) return kOk;
  if (map_.empty() || !input_.given(config_))
    throw base::Error("--map is needed, and --rawlog or --live: which images shall be located?");
  const std::string recordsPath = report_.empty() ? "" : (fs::path(report_) / "images.jsonl").string();
  for (const std::string& file : {csv_, recordsPath})
    if (!overwrite_ && !file.empty() && fs::exists(file))
      throw base::Error(file + " exists; give --overwrite to replace it");
  requireFolderOf(csv_);
  requireFolderOf(json_);
  makeFolder(report_);

  std::optional<store::MapFile> file = store::MapFile::open(map_, store::Access::kReadOnly);
  const pipeline::Use use = adapt_ ? pipeline::Use::kAdapting : pipeline::Use::kFrozen;
  pipeline::Pipeline localizer(config_.pipeline, file->load(), use);
  map::Cursor stored = localizer.map().now();
  store::requireCompatible(file->header(), localizer.header(), map_);
  if (adapt_) {
    file.reset();  // a map that is refused keeps every byte
    file = store::MapFile::open(map_, store::Access::kReadWrite);
  }
  std::optional<MapTruth> truth;
  if (!truth_.empty()) {
    truth.emplace(truth_, evaluation::TruthOptions{truthMargin_, truthRadius_, 1.0});
    truth->readPlaces(localizer.map());
  }

  stream_.open(map_);
  window_.open(config_.pipeline, map_, err);
  input_.open(config_, err);

  base::LineFile csv(csv_);
  base::LineFile records(recordsPath);
  LocalizeFigures figures(localizer.map(), truth ? &*truth : nullptr, csv);
  base::Progress progress(quiet_ ? nullptr : &err, "localising");
  while (const auto frame = input_.next()) {
    if (global_) localizer.restart();
    types::FrameReport report = localizer.process(*frame);
    input_.annotate(report);
    stream_.sendLocalised(report, localizer.map());
    if (adapt_) file->commit(localizer.map(), localizer.map().changesSince(stored), &report);
    figures.add(report);
    window_.after(*frame, report, localizer.map());
    if (records.wanted()) records.add(store::toJson(report));
    progress.update(input_.progress(), static_cast<std::size_t>(figures.images()));
  }
  progress.finish();
  if (adapt_) {
    figures.addLearnt(localizer.finish().size());
    file->commit(localizer.map(), localizer.map().changesSince(stored), nullptr);
    file->close();
  }
  const int code = conclude(figures, out, err);
  for (const base::LineFile* lines : {&csv, &records})
    if (!lines->failure().empty()) err << name() << ": " << lines->failure() << "\n";
  return csv.failure().empty() && records.failure().empty() ? code : kPartial;
}

int LocalizeProgram::conclude(const LocalizeFigures& figures, std::ostream& out, std::ostream& err) {
  input_.close();
  stream_.close(err);
  const std::string problem = input_.problem();
  if (figures.images() == 0 && !base::interrupted())
    throw base::Error(problem.empty() ? "no images" : problem);
  auto json = figures.toJson();
  json["live"] = input_.figures();
  writeJson(json_, json);
  if (!quiet_) {
    figures.print(stream_.summaryTo(out, err));
    stream_.summaryTo(out, err) << input_.summary();
  }
  if (!problem.empty()) err << name() << ": " << problem << "\n";
  if (base::interrupted()) err << name() << ": interrupted; the results hold every image up to here\n";
  return input_.exitCode();
}

}  // namespace engram::apps
