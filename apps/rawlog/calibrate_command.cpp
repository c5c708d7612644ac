// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "calibration.h"
#include "engram/apps/checks.h"
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/progress.h"
#include "engram/base/text.h"
#include "engram/sources/image_folder_source.h"
#include "engram/sources/image_pairs.h"
#include "engram/sources/rawlog_source.h"
#include "rawlog_program.h"
#include "stereo_calibration.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <ostream>

namespace engram::apps {
namespace {

class CalibrateCommand final : public Program {
 public:
  std::string name() const override { return "calibrate"; }
  std::string description() const override { return "Calibration file from images of a chessboard"; }
  std::string examples() const override {
    return "  engram-rawlog calibrate --images board --model unified --board 9x6 --square 0.03 --out "
           "omni.ini\n"
           "  engram-rawlog calibrate --rawlog board.rawlog --model pinhole --board 8x6 --square 0.025 --out "
           "cam.ini\n"
           "  engram-rawlog calibrate --stereo --images left --right right --board 9x6 --square 0.03 --out "
           "stereo.ini\n";
  }
  void declare(CLI::App& app) override;
  int run(std::ostream& out, std::ostream& err) override;

 private:
  void search(sources::FrameSource& source, std::ostream& err);
  void add(const types::Frame& frame);
  void print(std::ostream& out, const std::vector<CalibrationResult::View>& views, double rms) const;
  nlohmann::json figures(const std::vector<CalibrationResult::View>& views, double rms) const;
  std::unique_ptr<sources::FrameSource> open() const;
  void calibrateOne(std::ostream& out);
  void calibrateBoth(std::ostream& out);

  CommonOptions common_;
  std::string images_, right_, rawlog_, model_, board_, format_ = "engram", out_;
  bool overwrite_ = false, stereo_ = false;
  sources::RawlogParams source_;
  CalibrationOptions options_;
  cameras::MaskParams mask_;

  cv::Size size_;
  std::vector<BoardView> found_;
  std::vector<BoardPair> pairs_;
  std::vector<std::string> missed_;
};

void CalibrateCommand::declare(CLI::App& app) {
  auto* images = app.add_option("--images", images_, "Folder of images")->type_name("DIR");
  auto* rawlog = app.add_option("--rawlog", rawlog_, "Rawlog with the images")->type_name("FILE");
  images->excludes(rawlog);
  app.add_flag("--stereo", stereo_, "Both eyes of a stereo camera and the pose between them");
  app.add_option("--right", right_, "Folder of the images of the right eye, with --images")
      ->excludes(rawlog)
      ->type_name("DIR");
  app.add_option("--left-label", source_.sensor_label, "--rawlog: label of the (left) camera");
  app.add_option("--right-label", source_.right_label,
                 "--rawlog: label of the right camera, where both are recorded as cameras of their own");
  app.add_option(
         "--model", model_,
         "unified: mirrors and fisheyes (Mei), the default; pinhole: ordinary lenses, always with --stereo")
      ->check(CLI::IsMember({"unified", "pinhole"}));
  app.add_option("--format", format_, "--stereo: calibration file of Engram, or of MRPT's TStereoCamera")
      ->check(CLI::IsMember({"engram", "mrpt"}))
      ->capture_default_str();
  app.add_option("--board", board_, "Inner corners of the chessboard, as 9x6")->required()->type_name("WxH");
  app.add_option("--square", options_.square, "Side of a square [m]")->required()->check(positive());
  app.add_flag("--mirrored", options_.mirrored,
               "The camera looks into a mirror, so left and right are exchanged (a chessboard cannot tell)");
  app.add_option("--inner-radius", mask_.inner_radius, "Mask: ignored disc about the centre [px]")
      ->check(notNegative());
  app.add_option("--outer-radius", mask_.outer_radius, "Mask: ignored outside this circle [px]")
      ->check(notNegative());
  app.add_option("--out", out_, "Calibration file to write")->required()->type_name("FILE");
  app.add_flag("--overwrite", overwrite_, "Replace the file if it exists");
  common_.declare(app);
}

void CalibrateCommand::search(sources::FrameSource& source, std::ostream& err) {
  base::Progress progress(common_.progressTo(err), "looking for the board");
  while (!base::interrupted()) {
    const auto frame = source.next();
    if (!frame) break;
    if (size_.empty()) size_ = frame->image.size();
    add(*frame);
    progress.update(source.progress(), found_.size() + pairs_.size() + missed_.size());
  }
}

void CalibrateCommand::add(const types::Frame& frame) {
  const std::string name = rawlog_.empty() ? frame.label : "image " + std::to_string(frame.index);
  if (stereo_ && frame.right.empty())
    throw base::Error(name + ": has no right image; --stereo needs both eyes (--right, or --right-label)");
  if (frame.image.size() != size_ || (stereo_ && frame.right.size() != size_))
    throw base::Error(name + ": has another size than the images before; a calibration is for one size");
  if (stereo_) {
    if (auto pair = findBoards(frame.image, frame.right, options_.board, name))
      return pairs_.push_back(std::move(*pair));
  } else if (auto corners = findBoard(frame.image, options_.board)) {
    return found_.push_back({name, std::move(*corners)});
  }
  missed_.push_back(name);
}

void CalibrateCommand::print(std::ostream& out, const std::vector<CalibrationResult::View>& views,
                             double rms) const {
  char line[256];
  int used = 0;
  for (const auto& view : views) {
    used += view.used ? 1 : 0;
    if (view.used)
      std::snprintf(line, sizeof line, "  %s: %.3f px\n", view.name.c_str(), view.rms);
    else
      std::snprintf(line, sizeof line, "  %s: left out, it does not fit the others\n", view.name.c_str());
    out << line;
  }
  for (const auto& name : missed_) out << "  " << base::forTerminal(name) << ": board not found\n";
  std::snprintf(line, sizeof line, "%s: rms %.3f px over %d of %zu images\n", out_.c_str(), rms, used,
                views.size() + missed_.size());
  out << line;
}

nlohmann::json CalibrateCommand::figures(const std::vector<CalibrationResult::View>& views,
                                         double rms) const {
  nlohmann::json images = nlohmann::json::array();
  for (const auto& view : views)
    images.push_back({{"image", view.name}, {"rms_px", view.rms}, {"used", view.used}});
  return {{"rms_px", rms}, {"images", images}, {"not_found", missed_}};
}

std::unique_ptr<sources::FrameSource> CalibrateCommand::open() const {
  if (!rawlog_.empty()) return sources::openRawlog(rawlog_, source_);
  return right_.empty() ? sources::openImageFolder(images_) : sources::openImagePairs(images_, right_, "");
}

void CalibrateCommand::calibrateOne(std::ostream& out) {
  const auto result = calibrate(found_, size_, options_);
  cameras::CameraRig rig = cameras::makeRig(result.camera);
  rig.maskParams = mask_;
  const std::string text = cameras::toText(rig);
  cameras::parseCamera(text, out_);  // refuses a mask that leaves nothing, before anything is written
  base::writeText(out_, text, true);
  print(out, result.views, result.rms);
  auto json = figures(result.views, result.rms);
  json["camera"] = result.camera->toText();
  writeJson(common_.json, json);
}

void CalibrateCommand::calibrateBoth(std::ostream& out) {
  auto result = calibrateStereo(pairs_, size_, options_);
  result.rig.left.maskParams = result.rig.right.maskParams = mask_;
  const std::string text = cameras::toText(result.rig);
  cameras::parseStereoRig(text, out_);
  base::writeText(out_, format_ == "mrpt" ? cameras::toMrptText(result.rig) : text, true);
  print(out, result.views, result.rms);
  const double baseline = result.rig.T_left_right().translation().norm();
  char line[160];
  std::snprintf(line, sizeof line,
                "baseline %.4f m; after rectification rows differ by %.3f px, squares by %.2f mm (rms)\n",
                baseline, result.rowError, 1000 * result.squareError);
  out << line;
  auto json = figures(result.views, result.rms);
  json["baseline_m"] = baseline;
  json["row_rms_px"] = result.rowError;
  json["square_rms_m"] = result.squareError;
  json["camera"] = text;
  writeJson(common_.json, json);
}

int CalibrateCommand::run(std::ostream& out, std::ostream& err) {
  const auto [width, height] = parseSize(board_, "--board");
  if (width < 3 || height < 3)
    throw UsageError("--board '" + board_ + "': at least 3x3 inner corners are needed");
  options_.board = {width, height};
  options_.unified = !stereo_ && model_ != "pinhole";
  if (stereo_ && (model_ == "unified" || options_.mirrored))
    throw UsageError("--stereo calibrates ordinary lenses; leave --model unified and --mirrored out");
  if (!stereo_ && !right_.empty()) throw UsageError("--right is for --stereo");
  if (stereo_ && rawlog_.empty() && right_.empty())
    throw UsageError("--stereo needs the images of both eyes: --images LEFT --right RIGHT, or --rawlog FILE");
  if (images_.empty() == rawlog_.empty())
    throw UsageError("name the images: either --images DIR or --rawlog FILE");
  requireNew(out_, overwrite_);
  base::requireWritable(common_.json);
  const auto source = open();
  search(*source, err);
  if (base::interrupted()) return finish("interrupted; no calibration was written", false, false, err);
  stereo_ ? calibrateBoth(out) : calibrateOne(out);
  return finish(source->problem(), source->problem().empty(), false, err);
}

}  // namespace

std::unique_ptr<Program> makeCalibrateCommand() { return std::make_unique<CalibrateCommand>(); }

}  // namespace engram::apps
