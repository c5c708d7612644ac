// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "odometry/odometry_command.h"

#include "common/experiment.h"
#include "engram/apps/checks.h"
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/progress.h"
#include "odometry/odometry_figures.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <ostream>
#include <sstream>

namespace engram::apps {
namespace fs = std::filesystem;
namespace {

const std::vector<double> kLengths{1, 2, 5, 10, 20, 50, 100, 200, 500};  // [m]

}  // namespace

std::string OdometryCommand::description() const {
  return "Visual odometry from a stereo camera, drift and time";
}

std::string OdometryCommand::examples() const {
  return "  engram-eval odometry --rawlog office/session_01.rawlog --camera office/camera.ini --truth "
         "office/session_01.truth.tum --out vo\n";
}

void OdometryCommand::declare(CLI::App& command) {
  command.add_option("--rawlog", rawlog_, "Rawlog of a stereo camera")->type_name("FILE");
  command
      .add_option("--camera", camera_,
                  "Calibration of the stereo camera; default: the one that the rawlog holds")
      ->type_name("FILE");
  command.add_option("--truth", truth_, "True poses of the robot (TUM)")->type_name("FILE");
  command.add_option("--out", folder_, "Folder for trajectory.tum and frames.csv")->type_name("DIR");
  command.add_option("--json", json_, "File for the final figures")->type_name("FILE");
  command.add_option("--config", config_, "Configuration (.ini) with sections [source], [odometry]");
  command.add_option("--set", overrides_, "Override one key: section.key=value (repeatable)")
      ->take_all()
      ->allow_extra_args(false);
  command.add_flag(
      "--fit-body", fitBody_,
      "The body of the truth may be turned against the robot by a constant angle: find it first");
  command.add_flag("--wheels", wheels_,
                   "Predict the motion by the odometry of the rawlog; it is never mixed in");
  command.add_option("--every", every_, "Use every so many frames only")->check(wholeBetween(1, 1000));
  command.add_flag("--dump-config", dump_, "Print every key in force with its meaning, and stop");
  command.add_flag("--overwrite", overwrite_, "Replace the results in the folder");
  command.add_flag("-q,--quiet", quiet_, "No progress, no summary");
}

bool OdometryCommand::readConfig(std::ostream& out) {
  base::Config config;
  config.bind("source", source_);
  config.bind("odometry", odometry_);
  config.read(configOf(config_, overrides_));
  if (dump_) out << config.dump();
  return dump_;
}

void OdometryCommand::checkOutput() const {
  if (rawlog_.empty()) throw UsageError("--rawlog is needed: a rawlog of a stereo camera");
  base::requireWritable(json_);
  if (folder_.empty()) return;
  makeFolder(folder_);
  for (const char* name : {"trajectory.tum", "frames.csv"})
    requireNew((fs::path(folder_) / name).string(), overwrite_);
}

cameras::StereoRig OdometryCommand::rigOf(const sources::RawlogSource& source) const {
  if (!camera_.empty()) return cameras::loadStereoRig(camera_);
  if (source.calibration()) return *source.calibration();
  throw base::Error(rawlog_ + ": holds no calibration of a stereo camera; name one with --camera " +
                    "(engram-rawlog calibrate --stereo makes it)");
}

void OdometryCommand::drive(sources::RawlogSource& source, std::ostream& err) {
  base::Progress progress(quiet_ ? nullptr : &err, "odometry");
  auto frame = source.next();
  if (!frame) throw base::Error(source.problem());
  const cameras::Rectifier rectifier(rigOf(source));
  OdometryRunner runner(rectifier, odometry_, wheels_);
  for (; frame && !base::interrupted(); frame = source.next()) {
    if (frame->index % static_cast<std::uint64_t>(every_) != 0) continue;
    runner.add(*frame);
    progress.update(source.progress(), runner.drive().frames.size());
  }
  drive_ = runner.drive();
  health_ = runner.health();
}

void OdometryCommand::measureDrift() {
  if (truth_.empty()) return;
  if (std::none_of(drive_.frames.begin(), drive_.frames.end(), [](const auto& f) { return f.result.ok(); }))
    throw base::Error(rawlog_ + ": no motion was found; the last of " + std::to_string(drive_.frames.size()) +
                      " frames failed with " + toString(drive_.frames.back().result.reason));
  auto truth = evaluation::readPoses(truth_);
  if (fitBody_) {
    const auto R = evaluation::fitBody(drive_.pieces, truth);
    if (!R)
      throw base::Error(
          "--fit-body: the robot moved nearly always the same way, which does not tell how the body "
          "of the truth is turned");
    bodyAngle_ = Eigen::AngleAxisd(*R).angle();
    truth = evaluation::turnBody(truth, *R);
  }
  drift_ = evaluation::drift(drive_.pieces, truth, kLengths);
  if (!drift_.measured())
    throw base::Error(truth_ + ": has no poses at the stamps of " + rawlog_ +
                      ", or the drive is shorter than 1 m; do the two belong together?");
}

void OdometryCommand::writeFiles() const {
  if (folder_.empty()) return;
  std::ostringstream trajectory;
  for (std::size_t i = 0; i < drive_.pieces.size(); ++i) {
    if (i > 0) trajectory << "# the motion from here to the next pose is unknown\n";
    evaluation::writeTum(trajectory, drive_.pieces[i]);
  }
  base::writeText((fs::path(folder_) / "trajectory.tum").string(), trajectory.str(), true);
  base::writeText((fs::path(folder_) / "frames.csv").string(), tableOf(drive_.frames).toCsv(), true);
}

nlohmann::json OdometryCommand::figures() const {
  auto json = figuresJson(drive_, drift_);
  json["camera_check"] = toJson(health_);
  if (fitBody_) json["body_turned_deg"] = bodyAngle_ * 180 / std::numbers::pi;
  return json;
}

int OdometryCommand::run(std::ostream& out, std::ostream& err) {
  if (readConfig(out)) return kOk;
  checkOutput();
  const auto source = sources::openRawlog(rawlog_, source_);
  drive(*source, err);
  const std::string fault = describe(health_);
  try {
    measureDrift();
  } catch (const base::Error&) {
    if (fault.empty()) throw;  // otherwise the fault says why
  }
  writeFiles();
  writeJson(json_, figures());
  if (!quiet_) out << figuresText(drive_, drift_);
  if (!fault.empty()) err << "engram-eval: " << rawlog_ << ": " << fault << "\n";
  if (!source->problem().empty()) err << "engram-eval: " << source->problem() << "\n";
  if (base::interrupted()) err << "engram-eval: interrupted; the figures are of the frames so far\n";
  return source->whole() && fault.empty() && !base::interrupted() ? kOk : kPartial;
}

}  // namespace engram::apps
