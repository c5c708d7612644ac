// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/checks.h"
#include "engram/bags/bag_source.h"
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/progress.h"
#include "engram/base/text.h"
#include "engram/cameras/camera_import.h"
#include "engram/sources/rawlog_writer.h"
#include "engram/types/size_text.h"
#include "rawlog_program.h"

#include <nlohmann/json.hpp>

#include <ostream>

namespace engram::apps {
namespace {

class ImportCommand final : public Program {
 public:
  std::string name() const override { return "import"; }
  std::string description() const override {
    return "ROS bag to rawlog: images, calibration, mount and odometry";
  }
  std::string examples() const override {
    return "  engram-rawlog import walk.bag --out walk.rawlog\n"
           "  engram-rawlog import walk.mcap --image /cam/left/image_raw --right /cam/right/image_raw --out "
           "walk.rawlog\n"
           "  engram-rawlog info walk.bag     # its topics\n";
  }
  void declare(CLI::App& app) override;
  int run(std::ostream& out, std::ostream& err) override;

 private:
  void takeCalibration(const bags::BagSource& source, const types::Frame& first);
  std::size_t copy(bags::BagSource& source, types::Frame first, std::ostream& err);

  CommonOptions common_;
  std::string path_, out_, camera_;
  bags::BagSourceParams source_;
  sources::RawlogWriterParams writer_;
  std::size_t withOdometry_ = 0, wrongSize_ = 0;
};

void ImportCommand::declare(CLI::App& app) {
  app.add_option("bag", path_, "Bag of ROS 1 (.bag) or ROS 2 (.db3, .mcap, or its folder)")->required();
  app.add_option("--out", out_, "Rawlog to write")->required()->type_name("FILE");
  app.add_option("--image", source_.image,
                 "Topic of the (left) camera; default: the only one, or left of two")
      ->type_name("TOPIC");
  app.add_option("--right", source_.right, "Topic of the right camera")->type_name("TOPIC");
  app.add_option("--odometry", source_.odometry,
                 "Topic of the odometry, or tf: the frame odom of the transforms, or none; default: the only "
                 "topic, else tf")
      ->type_name("TOPIC");
  app.add_option("--base-frame", source_.base_frame,
                 "Frame of the robot, on which the camera is mounted; default: that of the odometry, or "
                 "base_link")
      ->type_name("FRAME");
  app.add_option("--sync", source_.sync, "Images of both eyes no further apart are one pair [s]")
      ->check(between(0, 1))
      ->capture_default_str();
  app.add_option("--camera", camera_, "Calibration to use instead of that in the bag")->type_name("FILE");
  app.add_option("--label", writer_.sensor_label, "Sensor label of the camera")->capture_default_str();
  app.add_option("--quality", writer_.jpeg_quality, "JPEG quality")
      ->check(wholeBetween(1, 100))
      ->capture_default_str();
  app.add_flag("--external", writer_.external_images, "Images as files beside the rawlog instead of inside");
  app.add_flag("--overwrite", writer_.overwrite, "Replace the rawlog if it exists");
  common_.declare(app);
}

void ImportCommand::takeCalibration(const bags::BagSource& source, const types::Frame& first) {
  writer_.camera = source.camera();
  writer_.stereo = source.stereo();
  if (camera_.empty()) return;
  const cv::Size size = first.image.size();
  if (cameras::isForeignCalibration(camera_))
    writer_.stereo = cameras::importStereoRig(camera_, size);
  else if (cameras::describesStereo(camera_))
    writer_.stereo = cameras::loadStereoRig(camera_);
  else
    writer_.stereo.reset();
  if (writer_.stereo)
    writer_.camera = writer_.stereo->left;
  else
    writer_.camera = cameras::isForeignCalibration(camera_) ? cameras::importCamera(camera_, size)
                                                            : cameras::loadCamera(camera_);
}

std::size_t ImportCommand::copy(bags::BagSource& source, types::Frame first, std::ostream& err) {
  const cv::Size size = first.image.size();
  if (writer_.camera && writer_.camera->camera->imageSize() != size)
    throw base::Error((camera_.empty() ? path_ + ": its camera_info" : camera_) + " is for images of " +
                      types::sizeText(writer_.camera->camera->imageSize()) + ", these have " +
                      types::sizeText(size) + "; give another with --camera");
  sources::RawlogWriter writer(out_, writer_);
  base::Progress progress(common_.progressTo(err), "import");
  for (std::optional<types::Frame> frame = std::move(first); frame;
       frame = base::interrupted() ? std::nullopt : source.next()) {
    if (frame->image.size() != size) {
      ++wrongSize_;
      continue;
    }
    withOdometry_ += frame->T_odom_robot ? 1 : 0;
    writer.add(*frame);
    progress.update(source.progress(), writer.frames());
  }
  progress.finish();
  writer.close();
  return writer.frames();
}

int ImportCommand::run(std::ostream& out, std::ostream& err) {
  requireNew(out_, writer_.overwrite);
  base::requireWritable(common_.json);
  const auto source = bags::openBagSource(path_, source_);
  auto first = source->next();
  if (!first)
    throw base::Error(source->problem().empty() ? path_ + ": no image of one eye has a partner within --sync"
                                                : source->problem());
  takeCalibration(*source, *first);
  const std::size_t images = copy(*source, std::move(*first), err);
  out << out_ << ": " << base::counted(images, "image") << ", " << withOdometry_ << " with odometry\n";
  for (const auto& note : source->notes()) out << "  " << base::forTerminal(note) << "\n";
  if (source->imagesUnpaired() > 0)
    out << "  " << base::counted(source->imagesUnpaired(), "image") << " of one eye without the other\n";
  if (wrongSize_ > 0) out << "  " << base::counted(wrongSize_, "image") << " of another size left out\n";
  writeJson(common_.json, {{"images", images},
                           {"images_with_odometry", withOdometry_},
                           {"images_unusable", source->imagesUnusable()},
                           {"images_unpaired", source->imagesUnpaired()},
                           {"images_other_size", wrongSize_},
                           {"camera_calibration", writer_.camera.has_value()},
                           {"stereo_calibration", writer_.stereo.has_value()},
                           {"notes", source->notes()},
                           {"problem", source->problem()}});
  return finish(source->problem(), source->problem().empty() && wrongSize_ == 0, base::interrupted(), err);
}

}  // namespace

std::unique_ptr<Program> makeImportCommand() { return std::make_unique<ImportCommand>(); }

}  // namespace engram::apps
