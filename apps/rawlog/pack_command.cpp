// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/checks.h"
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/base/image_header.h"
#include "engram/base/interrupt.h"
#include "engram/base/progress.h"
#include "engram/base/rng.h"
#include "engram/cameras/camera_import.h"
#include "engram/cameras/equirectangular.h"
#include "engram/cameras/stereo_rig.h"
#include "engram/sources/image_folder_source.h"
#include "engram/sources/image_pairs.h"
#include "engram/sources/rawlog_writer.h"
#include "rawlog_program.h"
#include "reprojector.h"

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <ostream>

namespace engram::apps {
namespace {

/// The rig for images of another size.
cameras::CameraRig scaledRig(const cameras::CameraRig& rig, cv::Size size) {
  if (rig.camera->imageSize() == size) return rig;
  const double fx = static_cast<double>(size.width) / rig.camera->imageSize().width;
  const double fy = static_cast<double>(size.height) / rig.camera->imageSize().height;
  cameras::CameraRig out = rig;
  out.camera = rig.camera->scaled(fx, fy);
  const double f = std::sqrt(fx * fy);  // the limits are circles
  out.maskParams.inner_radius *= f;
  out.maskParams.outer_radius *= f;
  out.maskParams.top_rows = static_cast<int>(std::lround(rig.maskParams.top_rows * fy));
  out.maskParams.bottom_rows = static_cast<int>(std::lround(rig.maskParams.bottom_rows * fy));
  cv::resize(rig.mask, out.mask, size, 0, 0, cv::INTER_NEAREST);
  return out;
}

class PackCommand final : public Program {
 public:
  std::string name() const override { return "pack"; }
  std::string description() const override {
    return "Image folder (and CSV) to rawlog, re-projected on request";
  }
  std::string examples() const override {
    return "  engram-rawlog pack --images photos --out walk.rawlog\n"
           "  engram-rawlog pack --images photos --csv photos/frames.csv --out walk.rawlog\n"
           "  engram-rawlog pack --images 'euroc/*_0.jpg' --right 'euroc/*_1.jpg' --stamps names "
           "--camera cam0.yaml,cam1.yaml --out euroc.rawlog\n"
           "  engram-rawlog pack --images panoramas --reproject share/cameras/omni_world.ini --heading "
           "random "
           "--seed 3 --out walk.rawlog\n";
  }
  void declare(CLI::App& app) override;
  int run(std::ostream& out, std::ostream& err) override;

 private:
  void prepare();
  types::Frame convert(types::Frame frame);
  void loadCalibration();
  void makeReprojector(cv::Size size);
  void checkCalibration(const types::Frame& frame) const;
  double nextHeading();
  std::unique_ptr<sources::ImageListSource> open() const;

  CommonOptions common_;
  std::string images_, right_, stamps_, csv_, stampUnit_, camera_, reproject_, heading_ = "0", size_, out_,
                                                                               saveCamera_;
  std::uint64_t seed_ = 1;
  double rate_ = 1.0;
  sources::RawlogWriterParams writer_;

  std::optional<cv::Size> wanted_;
  std::optional<cameras::CameraRig> from_, to_;
  std::optional<Reprojector> reprojector_;
  std::optional<base::Rng> rng_;
  double fixedHeading_ = 0.0;  // [rad]
  std::vector<double> headings_;
};

void PackCommand::declare(CLI::App& app) {
  app.add_option("--images", images_,
                 "Folder of images, or folder and pattern (cam/*_0.jpg); taken in natural order")
      ->required()
      ->type_name("DIR");
  auto* right =
      app.add_option("--right", right_,
                     "The same for the right eye of a stereo camera; paired with the left images by the "
                     "longest number in their names")
          ->type_name("DIR");
  auto* stamps =
      app.add_option("--stamps", stamps_,
                     "names: the number in a file name is Unix time (s, ms, us or ns); else a file with "
                     "one stamp a line")
          ->type_name("names|FILE");
  app.add_option("--csv", csv_, "Frames with columns image, stamp, right, x, y [m], yaw [rad]")
      ->excludes(right)
      ->excludes(stamps)
      ->type_name("FILE");
  app.add_option("--stamp-unit", stampUnit_,
                 "Unit of the stamps of --csv or of the file of --stamps; default: told from the stamps")
      ->check(CLI::IsMember(sources::stampUnitNames()));
  app.add_option("--out", out_, "Rawlog to write")->required()->type_name("FILE");
  app.add_flag("--overwrite", writer_.overwrite, "Replace the rawlog if it exists");
  app.add_option(
         "--camera", camera_,
         "Calibration of the images; default: equirectangular of their size. That of a pinhole or a stereo "
         "camera goes into the rawlog. Also of OpenCV, ROS, EuRoC (cam0.yaml,cam1.yaml) and KITTI "
         "(calib.txt)")
      ->type_name("FILE");
  app.add_option("--reproject", reproject_, "Calibration of the camera to show the images through")
      ->type_name("FILE");
  app.add_option("--heading", heading_, "Turn of the robot to the left [deg], or: random for each image")
      ->capture_default_str();
  app.add_option("--seed", seed_, "Of the random headings")->capture_default_str();
  app.add_option("--size", size_, "Size of the packed images; scales the camera too")->type_name("WxH");
  app.add_option("--save-camera", saveCamera_, "Write the calibration of the packed images")
      ->type_name("FILE");
  app.add_option("--rate", rate_, "Images per second without --csv or --stamps")
      ->check(between(1e-6, 1e6))
      ->capture_default_str();
  app.add_option("--label", writer_.sensor_label, "Sensor label of the camera")->capture_default_str();
  app.add_option("--quality", writer_.jpeg_quality, "JPEG quality")
      ->check(wholeBetween(1, 100))
      ->capture_default_str();
  app.add_flag("--external", writer_.external_images, "Images as files beside the rawlog instead of inside");
  common_.declare(app);
}

void PackCommand::prepare() {
  writer_.file_names = true;  // truth refers to them
  if (!stampUnit_.empty() && csv_.empty() && (stamps_.empty() || stamps_ == "names"))
    throw base::Error("--stamp-unit is for --csv and for --stamps FILE");
  if (!size_.empty()) {
    const auto [width, height] = parseSize(size_, "--size");
    wanted_ = cv::Size(width, height);
  }
  if (heading_ == "random") {
    rng_.emplace(seed_);
  } else {
    std::size_t used = 0;
    try {
      fixedHeading_ = std::stod(heading_, &used) * std::numbers::pi / 180.0;
    } catch (const std::exception&) {
      used = 0;
    }
    if (used != heading_.size() || !std::isfinite(fixedHeading_))
      throw UsageError("--heading '" + heading_ + "': expected degrees or the word random");
  }
  if (reproject_.empty() && (heading_ != "0"))
    throw UsageError("--heading turns the images only together with --reproject CAMERA");
  if (!camera_.empty()) loadCalibration();
  if (wanted_ && writer_.stereo)
    throw UsageError("--size cannot scale the calibration of a stereo camera; leave one of them out");
  if (!reproject_.empty()) to_ = cameras::loadCamera(reproject_);
  if (to_ && wanted_) to_ = scaledRig(*to_, *wanted_);
  if (!saveCamera_.empty() && !to_ && !from_)
    throw UsageError("--save-camera needs --camera or --reproject: which calibration should be written?");
  if (!writer_.stereo)
    writer_.camera = to_ || !from_ || !wanted_ ? (to_ ? to_ : from_) : scaledRig(*from_, *wanted_);
  requireNew(saveCamera_, writer_.overwrite);
  requireNew(out_, writer_.overwrite);
  base::requireWritable(common_.json);
}

cv::Size sizeOfImage(const std::string& path) {
  const auto size = base::sizeInHeader(base::readImageBytes(path));
  return {static_cast<int>(size->width), static_cast<int>(size->height)};
}

void PackCommand::loadCalibration() {
  if (cameras::isForeignCalibration(camera_)) {
    const cv::Size size = sizeOfImage(sources::findImages(images_).front());
    writer_.stereo = cameras::importStereoRig(camera_, size);
    from_ = writer_.stereo ? writer_.stereo->left : cameras::importCamera(camera_, size);
  } else {
    if (cameras::describesStereo(camera_)) writer_.stereo = cameras::loadStereoRig(camera_);
    from_ = writer_.stereo ? writer_.stereo->left : cameras::loadCamera(camera_);
  }
  if (!right_.empty() && !writer_.stereo)
    throw base::Error(camera_ + ": describes one camera, and --right gives two");
}

void PackCommand::makeReprojector(cv::Size size) {
  if (!from_) {
    if (size.width != 2 * size.height)
      throw base::Error(
          images_ + ": images of " + std::to_string(size.width) + "x" + std::to_string(size.height) +
          " are no full panoramas (width twice the height); name their calibration with --camera");
    from_ = cameras::makeRig(std::make_shared<cameras::Equirectangular>(size));
  }
  reprojector_.emplace(*from_, *to_);
}

void PackCommand::checkCalibration(const types::Frame& frame) const {
  if (!writer_.stereo || frame.right.empty()) return;
  const auto check = [&](const cv::Mat& image, const cameras::CameraRig& rig, const char* side) {
    const cv::Size wanted = rig.camera->imageSize();
    if (image.size() != wanted)
      throw base::Error(frame.label + ": the " + side + " image has " + std::to_string(image.cols) + "x" +
                        std::to_string(image.rows) + " pixels, " + camera_ + " is for " +
                        std::to_string(wanted.width) + "x" + std::to_string(wanted.height));
  };
  check(frame.image, writer_.stereo->left, "left");
  check(frame.right, writer_.stereo->right, "right");
}

double PackCommand::nextHeading() {
  const double heading = rng_ ? rng_->uniform(0.0, 2.0 * std::numbers::pi) : fixedHeading_;
  headings_.push_back(std::round(heading * 180.0 / std::numbers::pi * 1e6) / 1e6);
  return heading;
}

types::Frame PackCommand::convert(types::Frame frame) {
  if (csv_.empty() && stamps_.empty()) frame.stamp = static_cast<double>(frame.index) / rate_;
  if (to_) {
    if (!frame.right.empty()) throw base::Error("--reproject does not work on stereo pairs");
    if (!reprojector_) makeReprojector(frame.image.size());
    const double heading = nextHeading();
    try {
      frame.image = (*reprojector_)(frame.image, heading);
    } catch (const base::Error& e) {
      throw base::Error(images_ + "/" + frame.label + ": " + e.what());
    }
  } else if (wanted_) {
    cv::resize(frame.image, frame.image, *wanted_, 0, 0, cv::INTER_AREA);
    if (!frame.right.empty()) cv::resize(frame.right, frame.right, *wanted_, 0, 0, cv::INTER_AREA);
  }
  return frame;
}

std::unique_ptr<sources::ImageListSource> PackCommand::open() const {
  const auto unit = sources::stampUnitOf(stampUnit_);
  return csv_.empty() ? sources::openImagePairs(images_, right_, stamps_, unit)
                      : sources::openImageFolder(images_, csv_, unit);
}

int PackCommand::run(std::ostream& out, std::ostream& err) {
  prepare();
  const auto source = open();
  sources::RawlogWriter writer(out_, writer_);
  base::Progress progress(common_.progressTo(err), "pack");
  cv::Size size;
  while (!base::interrupted()) {
    auto frame = source->next();
    if (!frame) break;
    const types::Frame converted = convert(std::move(*frame));
    size = converted.image.size();
    checkCalibration(converted);
    writer.add(converted);
    progress.update(source->progress(), writer.frames());
  }
  progress.finish();
  if (writer.frames() == 0 && base::interrupted())
    return finish("interrupted before the first image", false, false, err);
  if (writer.frames() == 0)
    throw base::Error(images_ + ": none of the images can be used; " + source->problem());
  writer.close();
  if (!saveCamera_.empty() && writer_.stereo)
    base::writeText(saveCamera_, cameras::toText(*writer_.stereo), writer_.overwrite);
  else if (!saveCamera_.empty())
    cameras::saveCamera(to_ ? *to_ : scaledRig(*from_, size), saveCamera_);
  const auto bytes = writer.bytes();  // 0 of a pipe
  out << out_ << ": " << writer.frames() << " images of " << size.width << "x" << size.height;
  if (bytes > 0) out << ", " << bytes / 1024 << " KB";
  out << "\n";
  const sources::StampReading stamps = source->stampReading();
  if (!stamps.why.empty()) out << "  " << stamps.why << "; --stamp-unit forces another\n";
  if (!source->clockNote().empty()) out << "  " << source->clockNote() << "\n";
  writeJson(common_.json, {{"images", writer.frames()},
                           {"width", size.width},
                           {"height", size.height},
                           {"bytes", bytes},
                           {"headings_deg", headings_},
                           {"stamp_unit", toString(stamps.unit)},
                           {"problem", source->problem()}});
  return finish(source->problem(), source->problem().empty(), base::interrupted(), err);
}

}  // namespace

std::unique_ptr<Program> makePackCommand() { return std::make_unique<PackCommand>(); }

}  // namespace engram::apps
