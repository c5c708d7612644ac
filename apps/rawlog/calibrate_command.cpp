// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "calibration.h"
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/progress.h"
#include "engram/sources/image_folder_source.h"
#include "engram/sources/rawlog_source.h"
#include "rawlog_program.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <ostream>

namespace engram::apps {
namespace {

class CalibrateCommand final : public RawlogCommand {
 public:
  std::string name() const override { return "calibrate"; }
  std::string description() const override { return "Calibration file from images of a chessboard"; }
  std::string examples() const override {
    return "  engram-rawlog calibrate --images board --model unified --board 9x6 --square 0.03 --out "
           "omni.ini\n"
           "  engram-rawlog calibrate --rawlog board.rawlog --model pinhole --board 8x6 --square 0.025 --out "
           "cam.ini\n";
  }
  void declare(CLI::App& app) override;
  int run(std::ostream& out, std::ostream& err) override;

 private:
  void search(sources::FrameSource& source, std::ostream& err);
  void print(std::ostream& out, const CalibrationResult& result) const;
  nlohmann::json figures(const CalibrationResult& result) const;

  CommonOptions common_;
  std::string images_, rawlog_, model_ = "unified", board_, out_;
  bool overwrite_ = false;
  CalibrationOptions options_;
  cameras::MaskParams mask_;

  cv::Size size_;
  std::vector<BoardView> found_;
  std::vector<std::string> missed_;
};

void CalibrateCommand::declare(CLI::App& app) {
  auto* images = app.add_option("--images", images_, "Folder of images")->type_name("DIR");
  auto* rawlog = app.add_option("--rawlog", rawlog_, "Rawlog with the images")->type_name("FILE");
  images->excludes(rawlog);
  app.add_option("--model", model_, "unified: mirrors and fisheyes (Mei); pinhole: ordinary lenses")
      ->check(CLI::IsMember({"unified", "pinhole"}))
      ->capture_default_str();
  app.add_option("--board", board_, "Inner corners of the chessboard, as 9x6")->required()->type_name("WxH");
  app.add_option("--square", options_.square, "Side of a square [m]")->required()->check(CLI::PositiveNumber);
  app.add_flag("--mirrored", options_.mirrored,
               "The camera looks into a mirror, so left and right are exchanged (a chessboard cannot tell)");
  app.add_option("--inner-radius", mask_.inner_radius, "Mask: ignored disc about the centre [px]")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--outer-radius", mask_.outer_radius, "Mask: ignored outside this circle [px]")
      ->check(CLI::NonNegativeNumber);
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
    const std::string name = rawlog_.empty() ? frame->label : "image " + std::to_string(frame->index);
    if (frame->image.size() != size_)
      throw base::Error(name + ": has another size than the images before; a calibration is for one size");
    if (auto corners = findBoard(frame->image, options_.board))
      found_.push_back({name, std::move(*corners)});
    else
      missed_.push_back(name);
    progress.update(source.progress(), found_.size() + missed_.size());
  }
}

void CalibrateCommand::print(std::ostream& out, const CalibrationResult& result) const {
  char line[256];
  int used = 0;
  for (const auto& view : result.views) {
    used += view.used ? 1 : 0;
    if (view.used)
      std::snprintf(line, sizeof line, "  %s: %.3f px\n", view.name.c_str(), view.rms);
    else
      std::snprintf(line, sizeof line, "  %s: left out, it does not fit the others\n", view.name.c_str());
    out << line;
  }
  for (const auto& name : missed_) out << "  " << name << ": board not found\n";
  std::snprintf(line, sizeof line, "%s: rms %.3f px over %d of %zu images\n", out_.c_str(), result.rms, used,
                found_.size() + missed_.size());
  out << line;
}

nlohmann::json CalibrateCommand::figures(const CalibrationResult& result) const {
  nlohmann::json views = nlohmann::json::array();
  for (const auto& view : result.views)
    views.push_back({{"image", view.name}, {"rms_px", view.rms}, {"used", view.used}});
  return {
      {"rms_px", result.rms}, {"images", views}, {"not_found", missed_}, {"camera", result.camera->toText()}};
}

int CalibrateCommand::run(std::ostream& out, std::ostream& err) {
  const auto [width, height] = parseSize(board_, "--board");
  if (width < 3 || height < 3)
    throw base::Error("--board '" + board_ + "': at least 3x3 inner corners are needed");
  options_.board = {width, height};
  options_.unified = model_ == "unified";
  if (images_.empty() == rawlog_.empty())
    throw base::Error("name the images: either --images DIR or --rawlog FILE");
  if (!overwrite_ && std::filesystem::exists(out_))
    throw base::Error(out_ + ": exists already; choose another name or give --overwrite");
  std::unique_ptr<sources::FrameSource> source;
  if (rawlog_.empty())
    source = sources::openImageFolder(images_);
  else
    source = sources::openRawlog(rawlog_);
  search(*source, err);
  if (base::interrupted()) return finish("interrupted; no calibration was written", false, false, err);
  const auto result = calibrate(found_, size_, options_);
  cameras::CameraRig rig = cameras::makeRig(result.camera);
  rig.maskParams = mask_;
  const std::string text = cameras::toText(rig);
  cameras::parseCamera(text, out_);  // refuses a mask that leaves nothing, before anything is written
  base::writeText(out_, text, true);
  print(out, result);
  writeJson(common_.json, figures(result));
  return finish(source->problem(), source->problem().empty(), false, err);
}

}  // namespace

std::unique_ptr<RawlogCommand> makeCalibrateCommand() { return std::make_unique<CalibrateCommand>(); }

}  // namespace engram::apps
