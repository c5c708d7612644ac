// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "world_program.h"

#include "engram/apps/checks.h"
#include "engram/apps/config_file.h"
#include "engram/base/atomic_file.h"
#include "engram/base/config.h"
#include "engram/base/error.h"
#include "engram/cameras/stereo_rig.h"
#include "plan_picture.h"

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include <filesystem>
#include <iostream>
#include <numbers>
#include <sstream>

namespace engram::apps {
namespace fs = std::filesystem;

std::string WorldProgram::description() const {
  return "Simulates a robot with a camera in a building that changes over months, and writes what it saw as "
         "MRPT rawlogs\n"
         "with the true poses beside them.";
}

std::string WorldProgram::examples() const {
  return "  engram-world make --preset tiny --camera omni --sessions 2 --out tiny_world\n"
         "  engram-world make --preset office --camera omni --sessions 8 --seed 3 --test-drive --threads 2 "
         "--out office\n"
         "  engram-world make --plan hall.txt --camera my_camera.ini --sessions 1 --set change.people=0 "
         "--out hall\n"
         "  engram-world render --preset office --pose 4,7,90 --camera pinhole --session 3 --out view.png\n"
         "  engram-world plan --preset office --out office.txt      (edit it and give it to --plan)\n";
}

void WorldProgram::declareCommon(CLI::App& command) {
  command
      .add_option(
          "--preset", preset_,
          "Building: tiny, office, corridors, campus (streets), loops, rooms or tower (storeys alike)")
      ->capture_default_str();
  command.add_option("--plan", planFile_, "Building from a text plan instead of a preset")
      ->check(CLI::ExistingFile);
  command.add_option("--seed", params_.seed, "Seed of everything random")->capture_default_str();
  command.add_option("--textures", params_.photographs, "Folder of photographs that hang as posters");
  command.add_option("--config", config_, "Configuration (.ini) with sections [change], [drive], [sensor]");
  command.add_option("--set", overrides_, "Override one key: section.key=value (repeatable)")
      ->take_all()
      ->allow_extra_args(false);
  command.add_flag("--dump-config", dump_, "Print every key in force with its meaning, and stop");
  command.add_option("--threads", threads_, "Threads; the output does not depend on it")
      ->capture_default_str()
      ->check(wholeBetween(1, 256));
}

void WorldProgram::declare(CLI::App& app) {
  app.require_subcommand(1);
  make_ = app.add_subcommand("make", "Make a data set: rawlogs, truth, calibration, plan");
  declareCommon(*make_);
  make_->add_option("--camera", camera_, "omni, pinhole, stereo, or a calibration file (.ini)")
      ->capture_default_str();
  make_->add_option("--sessions", dataSet_.sessions, "Tours through the building, days or weeks apart")
      ->capture_default_str()
      ->check(wholeBetween(1, 99));
  make_->add_option("--out", dataSet_.folder, "Folder of the data set");
  make_->add_flag("--test-drive", dataSet_.testDrive,
                  "One more drive at other positions and headings: test.rawlog");
  make_->add_option("--spacing", spacing_, "Metres between images (drive.spacing)")->check(positive());
  make_->add_option("--layout", dataSet_.layout, "Rawlog of observations, or of actions and sensory frames")
      ->transform(CLI::CheckedTransformer(std::vector<std::pair<std::string, RawlogLayout>>{
          {"observations", RawlogLayout::kObservations}, {"actions", RawlogLayout::kActions}}));
  make_->add_flag("--external-images", dataSet_.externalImages, "Images as files beside the rawlog");
  make_->add_flag("--overwrite", dataSet_.overwrite, "Replace what is there");
  make_->add_option("--json", json_, "Write the final figures to this file");
  make_->add_flag("-q,--quiet", quiet_, "No progress, no summary");

  render_ = app.add_subcommand("render", "Render one picture");
  declareCommon(*render_);
  render_
      ->add_option("--camera", camera_,
                   "omni, pinhole, stereo (its left camera), or a calibration file (.ini)")
      ->capture_default_str();
  render_->add_option("--pose", pose_,
                      "x,y,heading of the robot [m, m, degrees]; default: start of the tour");
  render_->add_option("--session", session_, "Which day")->capture_default_str()->check(wholeBetween(1, 999));
  render_->add_option("--out", out_, "Picture (.png or .jpg)");

  plan_ = app.add_subcommand("plan", "Write the plan of a building: as text (.txt) or as a picture (.png)");
  declareCommon(*plan_);
  plan_->add_option("--out", out_, "File; without it the text is printed");
}

void WorldProgram::readConfig() {
  base::IniFile ini = config_.empty() ? base::IniFile::parse("", "command line") : loadConfig(config_);
  for (const auto& assignment : overrides_) ini.override(assignment);
  base::Config config;
  config.bind("change", params_.change);
  config.bind("drive", params_.drive);
  config.bind("sensor", params_.sensor);
  config.read(ini);
  if (spacing_) params_.drive.spacing = *spacing_;
  base::validate(params_.drive);
}

world::Plan WorldProgram::plan() const {
  return planFile_.empty() ? world::presetPlan(preset_, params_.seed) : world::loadPlan(planFile_);
}

world::Eyes WorldProgram::eyes() const {
  if (camera_.size() < 5 || camera_.substr(camera_.size() - 4) != ".ini") return world::presetEyes(camera_);
  if (!cameras::describesStereo(camera_)) return {camera_, cameras::loadCamera(camera_), {}};
  auto [left, right] = cameras::loadStereoRig(camera_);
  return {camera_, std::move(left), std::move(right)};
}

int WorldProgram::run(std::ostream& out, std::ostream& err) {
  readConfig();
  if (dump_) {
    base::Config config;
    config.bind("change", params_.change);
    config.bind("drive", params_.drive);
    config.bind("sensor", params_.sensor);
    out << config.dump();
    return kOk;
  }
  if (make_->parsed()) return make(out, err);
  return render_->parsed() ? render(out) : showPlan(out);
}

int WorldProgram::make(std::ostream& out, std::ostream& err) {
  if (dataSet_.folder.empty()) throw UsageError("make: --out is required");
  base::requireWritable(json_);
  const world::Eyes sight = eyes();
  const world::World world(plan(), params_);
  dataSet_.preset = planFile_.empty() ? preset_ : planFile_;
  dataSet_.threads = threads_;
  dataSet_.quiet = quiet_;
  const DataSetFigures f = makeDataSet(world, sight, dataSet_, err);
  writeJson(json_, {{"sessions", f.sessions},
                    {"images", f.images},
                    {"seconds", f.seconds},
                    {"ms_per_frame", f.msPerFrame},
                    {"places", world.route().stations()},
                    {"route_m", world.route().length()},
                    {"complete", !f.stopped},
                    {"peak_rss_bytes", peakResidentBytes()}});
  if (!quiet_) {
    char line[160];
    std::snprintf(line, sizeof line,
                  "%d sessions, %zu images, %d places on a tour of %.1f m; %.1f s, %.0f ms an image\n",
                  f.sessions, f.images, world.route().stations(), world.route().length(), f.seconds,
                  f.msPerFrame);
    out << line << "in " << dataSet_.folder << "\n";
  }
  if (f.stopped) err << name() << ": stopped; the sessions listed in world.json are complete\n";
  return f.stopped ? kPartial : kOk;
}

int WorldProgram::render(std::ostream& out) {
  if (out_.empty()) throw UsageError("render: --out is required, for example --out view.png");
  const std::string ending = out_ == base::kStandardOutput ? ".png" : fs::path(out_).extension().string();
  if (ending != ".png" && ending != ".jpg") throw UsageError("--out '" + out_ + "' must end in .png or .jpg");
  base::requireWritable(out_);
  const world::Eyes sight = eyes();
  const world::World world(plan(), params_);
  world::Pose2 pose = world.route().at(0);
  if (!pose_.empty()) {
    std::istringstream in(pose_);
    char comma1 = 0, comma2 = 0;
    if (!(in >> pose.x >> comma1 >> pose.y >> comma2 >> pose.heading) || comma1 != ',' || comma2 != ',' ||
        !in.eof())
      throw UsageError("--pose '" + pose_ + "' is not x,y,heading, for example 4,7,90");
    pose.heading *= std::numbers::pi / 180;
  }
  const world::Appearance appearance = world.appearance(session_);
  const cv::Mat image = world::renderAt(world, appearance, sight.left, pose, threads_);
  std::vector<unsigned char> bytes;
  cv::imencode(ending, image, bytes);
  base::writeText(out_, std::string(bytes.begin(), bytes.end()), true);
  out << "session " << session_ << ": " << appearance.inWords() << "\n";
  return kOk;
}

int WorldProgram::showPlan(std::ostream& out) {
  base::requireWritable(out_);
  const world::Plan p = plan();
  const bool picture = out_.size() > 4 && out_.substr(out_.size() - 4) == ".png";
  if (out_.empty()) {
    out << p.toText();
  } else if (!picture) {
    base::writeText(out_, p.toText(), true);
  } else {
    const world::World world(p, params_);
    std::vector<unsigned char> png;
    cv::imencode(".png", drawPlan(world, world.appearance(1)), png);
    base::writeText(out_, std::string(png.begin(), png.end()), true);
  }
  return kOk;
}

}  // namespace engram::apps
