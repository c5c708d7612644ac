// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "localize_program.h"

#include "engram/apps/checks.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/line_file.h"
#include "engram/base/progress.h"
#include "engram/base/text.h"
#include "engram/store/map_copy.h"
#include "engram/store/map_file.h"
#include "engram/store/report_json.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <ostream>

namespace engram::apps {
namespace fs = std::filesystem;
namespace {

constexpr int kTeachesOnly = -1;  // the session of a drive that has no path in the map

}  // namespace

std::string LocalizeProgram::description() const {
  return "Says where the images of a rawlog or of a live camera were taken in a map. The map does not "
         "change, unless --adapt "
         "lets its places "
         "learn from what they are verified to look like.";
}

std::string LocalizeProgram::examples() const {
  return "  engram-localize --map office.engram --rawlog day3.rawlog --out day3.csv\n"
         "  engram-localize --map office.engram --rawlog day3.rawlog --adapt\n"
         "  engram-localize --map office.engram --rawlog test.rawlog --truth test.truth.tum\n"
         "  engram-localize --map left.engram --images right --truth truth.csv\n"
         "  engram-localize robot.ini --map office.engram --live front --stream /tmp/engram\n";
}

void LocalizeProgram::declare(CLI::App& app) {
  config_.declare(app);
  app.add_option("--map", map_, "Map made by engram-slam");
  input_.declare(app);
  const auto adapt = app.add_flag("--adapt", adapt_, "Let recognised places learn; the map file is changed");
  app.add_flag("--resume", resume_, "Finish a drive with --adapt that was cut off")->needs(adapt);
  app.add_flag("--again", again_, "With --adapt: learn from a rawlog that the map has learnt before")
      ->needs(adapt);
  app.add_flag("--global", global_,
               "Forget the belief before every image: global localisation of single images");
  app.add_option("--truth", truth_,
                 "Ground truth: query,first,last | image,matches | a,b links | TUM poses of this drive");
  app.add_option("--truth-margin", truthMargin_, "Widens the truth by so many images, links or places")
      ->check(wholeFrom(0));
  app.add_option("--truth-radius", truthRadius_, "With TUM truth, places this near are right too [m]")
      ->check(positive());
  app.add_option("--out", csv_, "File for one line an image (.csv)");
  app.add_option("--report", report_, "Folder for the record of every image and the summary");
  stream_.declare(app);
  window_.declare(app);
  app.add_option("--json", json_, "File for the final figures");
  app.add_flag("--overwrite", overwrite_, "Replace existing output files");
  app.add_flag("-q,--quiet", quiet_, "No progress, no summary");
}

int LocalizeProgram::run(std::ostream& out, std::ostream& err) {
  if (config_.load(out, map_)) return kOk;
  if (map_.empty() || !input_.given(config_))
    throw UsageError(
        "--map is needed, and --rawlog, --images, --video or --live: which images shall be located?");
  const std::string recordsPath = report_.empty() ? "" : (fs::path(report_) / "images.jsonl").string();
  makeFolder(report_);
  for (const std::string& file : {csv_, recordsPath}) requireNew(file, overwrite_ || resume_);
  base::requireWritable(json_);

  if (const std::string missing = store::missingLog(map_); !missing.empty())
    err << name() << ": warning: map '" << map_ << "': " << missing << "\n";
  std::optional<store::DriveWriter> drive = openToAdapt(err);
  if (drive && drive->complete()) {
    if (!quiet_) out << map_ << ": holds the whole drive already; nothing to resume\n";
    return kOk;
  }
  if (config_.liveSection.empty())
    input_.open(config_, err);  // tells the calibration; a live camera starts last
  pipeline::Pipeline localizer = open(drive ? &*drive : nullptr);
  std::optional<MapTruth> truth;
  if (!truth_.empty()) {
    truth.emplace(truth_, evaluation::TruthOptions{truthMargin_, truthRadius_, 1.0});
    truth->readPlaces(localizer.map());
  }

  stream_.open(map_, err);
  window_.open(config_.pipeline, map_, err);
  input_.open(config_, err);

  base::LineFile csv(csv_);
  base::LineFile records(recordsPath);
  LocalizeFigures figures(localizer.map(), truth ? &*truth : nullptr, csv);
  base::Progress progress(quiet_ ? nullptr : &err, "localising");
  while (const auto frame = input_.next()) {
    if (drive && figures.images() == 0) drive->begin(*frame, kTeachesOnly, localizer.header());
    if (global_) localizer.restart();
    types::FrameReport report = localizer.process(*frame);
    input_.annotate(report);
    if (drive) drive->add(localizer.map(), report);
    if (!drive || !drive->replayed()) stream_.sendLocalised(report, localizer.map());
    say(eyes_.after(localizer.eyes()), err);
    figures.add(report);
    if (truth) truth->note(report);
    window_.after(*frame, report, localizer.map());
    if (frozen_) frozen_->yieldToWriter();
    if (records.wanted()) records.add(store::toJson(report));
    progress.update(input_.progress(), static_cast<std::size_t>(figures.images()));
  }
  progress.finish();
  say(eyes_.after(localizer.eyes(), true), err);
  figures.use().requireSome();
  if (drive && figures.images() > 0) {
    figures.addLearnt(localizer.finish().size());
    drive->end(localizer.map(), input_.exitCode() == kOk);
    drive->keep(localizer.derived());
    drive->file().close();
    notice_ = drive->notice();
  }
  if (truth && !base::interrupted()) truth->requireMatch(localizer.map(), err);
  const int code = conclude(localizer, figures, out, err);
  for (const base::LineFile* lines : {&csv, &records})
    if (!lines->failure().empty()) err << name() << ": " << lines->failure() << "\n";
  return csv.failure().empty() && records.failure().empty() ? code : kPartial;
}

std::optional<store::DriveWriter> LocalizeProgram::openToAdapt(std::ostream& err) {
  if (!adapt_) return std::nullopt;
  const store::DriveOptions options{.extend = true, .resume = resume_, .again = again_};
  if (!resume_) return store::DriveWriter(map_, options, input_.source(config_));
  input_.open(config_, err);
  if (input_.live()) throw base::Error("--resume goes with --rawlog");
  return store::DriveWriter(map_, options, input_.source(config_), input_.peek());
}

/// A frozen map is read as far as it is needed, and let go when others want to write it.
pipeline::Pipeline LocalizeProgram::open(store::DriveWriter* drive) {
  if (drive == nullptr) frozen_ = store::MapFile::open(map_, store::Access::kReadOnly);
  pipeline::Pipeline localizer(config_.pipeline, frozen_ ? frozen_->loadOnDemand() : drive->load(),
                               adapt_ ? pipeline::Use::kAdapting : pipeline::Use::kFrozen);
  store::requireCompatible(frozen_ ? frozen_->header() : *drive->header(), localizer.header(), map_);
  return localizer;
}

int LocalizeProgram::conclude(const pipeline::Pipeline& localizer, const LocalizeFigures& figures,
                              std::ostream& out, std::ostream& err) {
  input_.close();
  stream_.close(err);
  const std::string problem = input_.problem();
  if (figures.images() == 0 && !base::interrupted())
    throw base::Error(problem.empty() ? "no images" : problem);
  auto json = figures.toJson();
  json["live"] = input_.figures();
  json["odometry"] = toJson(localizer.wheels());
  writeJson(json_, json);
  if (!quiet_) {
    figures.print(stream_.summaryTo(out, err));
    stream_.summaryTo(out, err) << input_.summary();
  }
  say(problem, err);
  if (base::interrupted()) err << name() << ": interrupted; the results hold every image up to here\n";
  say(figures.use().complaint(), err);
  say(pipeline::describe(localizer.wheels()), err);
  say(notice_, err);
  const bool sound = notice_.empty() && figures.use().complaint().empty() && !eyes_.faulty() &&
                     !pipeline::isGrave(localizer.wheels()) && !stream_.failed();
  return sound ? input_.exitCode() : kPartial;
}

}  // namespace engram::apps
