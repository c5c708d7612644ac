// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/bags/bag.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/progress.h"
#include "engram/base/text.h"
#include "engram/cameras/rectifier.h"
#include "engram/odometry/stereo_check.h"
#include "engram/sources/rawlog_source.h"
#include "engram/types/size_text.h"
#include "rawlog_program.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <map>
#include <ostream>

namespace engram::apps {
namespace {

std::string fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

/// What the images of a rawlog have in common, gathered frame by frame.
struct ImageSummary {
  std::map<std::string, std::size_t> sizes;
  std::size_t stereo = 0, grey = 0, withOdometry = 0, images = 0;
  double first = 0.0, last = 0.0;

  void add(const types::Frame& frame) {
    ++sizes[types::sizeText(frame.image.size())];
    stereo += frame.right.empty() ? 0 : 1;
    grey += frame.image.channels() == 1 ? 1 : 0;
    withOdometry += frame.T_odom_robot ? 1 : 0;
    if (images++ == 0) first = frame.stamp;
    last = frame.stamp;
  }
  double rate() const {
    return images > 1 && last > first ? static_cast<double>(images - 1) / (last - first) : 0.0;
  }
};

/// Looks for faults of a stereo camera in the pairs of a rawlog.
class EyeInspector {
 public:
  /// @param rig the calibration in force at this frame.
  void add(const types::Frame& frame, const std::optional<cameras::StereoRig>& rig) {
    if (frame.right.empty() || !rig || !mistake_.empty()) return;
    try {
      if (!rectifier_) rectifier_.emplace(*rig);
      check_.add((*rectifier_)(frame.image, frame.right));
    } catch (const base::Error& e) {
      mistake_ = e.what();
    }
  }
  odometry::StereoHealth health() const { return check_.health(); }
  /// What is wrong with the calibration or the eyes; empty when nothing is known to be.
  std::string fault() const { return mistake_.empty() ? describe(health()) : mistake_; }

 private:
  std::optional<cameras::Rectifier> rectifier_;
  odometry::StereoCheck check_;
  std::string mistake_;
};

class InfoCommand final : public Program {
 public:
  std::string name() const override { return "info"; }
  std::string description() const override {
    return "What a rawlog or a ROS bag holds, and whether it is damaged";
  }
  std::string examples() const override {
    return "  engram-rawlog info walk.rawlog\n  engram-rawlog info walk.bag     # its topics\n"
           "  engram-rawlog info walk.rawlog --json walk.json\n"
           "  engram-rawlog info stereo.rawlog --camera stereo.ini    # are the eyes in order?\n";
  }
  void declare(CLI::App& app) override {
    app.add_option("rawlog", path_, "Rawlog to read, gzip or plain, or bag (.bag, .db3, .mcap, folder)")
        ->required();
    app.add_option("--sensor-label", params_.sensor_label, "Camera to look at; default: the first one");
    app.add_option("--right-label", params_.right_label,
                   "Right camera, where both eyes are recorded as cameras of their own");
    app.add_option("--camera", camera_,
                   "Calibration of the stereo camera, to check its eyes by; default: that of the rawlog")
        ->type_name("FILE");
    app.add_option("--images-dir", params_.images_dir, "Folder of images stored outside")->type_name("DIR");
    common_.declare(app);
  }
  int run(std::ostream& out, std::ostream& err) override;

 private:
  int runOnBag(std::ostream& out, std::ostream& err) const;
  void print(std::ostream& out, const sources::RawlogSource& source, const ImageSummary& images) const;
  nlohmann::json figures(const sources::RawlogStats& stats, const ImageSummary& images) const;

  CommonOptions common_;
  std::string path_, camera_;
  sources::RawlogParams params_;
  std::optional<cameras::StereoRig> rig_;  // of --camera
};

int InfoCommand::run(std::ostream& out, std::ostream& err) {
  base::requireWritable(common_.json);
  if (bags::isBag(path_)) return runOnBag(out, err);
  if (!camera_.empty()) rig_ = cameras::loadStereoRig(camera_);
  const auto source = sources::openRawlog(path_, params_);
  ImageSummary images;
  EyeInspector eyes;
  {
    base::Progress progress(common_.progressTo(err), "info");
    while (!base::interrupted()) {
      const auto frame = source->next();
      if (!frame) break;
      images.add(*frame);
      eyes.add(*frame, rig_ ? rig_ : source->calibration());
      progress.update(source->progress(), images.images);
    }
  }
  print(out, *source, images);
  auto json = figures(source->stats(), images);
  json["stereo_calibration"] = source->calibration().has_value();
  const std::string fault = eyes.fault();
  if (images.stereo > 0)
    json["stereo_check"] = {{"fault", toString(eyes.health().fault)},
                            {"message", fault},
                            {"row_error_px", eyes.health().rowError},
                            {"pairs", eyes.health().pairs}};
  json["damage"] = source->damage();
  json["problem"] = source->problem();
  writeJson(common_.json, json);
  if (!fault.empty()) err << "engram-rawlog: " << path_ << ": " << fault << "\n";
  return finish(source->problem(), source->whole() && fault.empty(), base::interrupted(), err);
}

int InfoCommand::runOnBag(std::ostream& out, std::ostream& err) const {
  const auto reader = bags::openBag(path_);
  {
    base::Progress progress(common_.progressTo(err), "info");
    for (std::size_t n = 0; !base::interrupted() && reader->next(); ++n)
      progress.update(reader->progress(), n);
  }
  out << path_ << ": bag of ROS; engram-rawlog import makes a rawlog of it\n";
  nlohmann::json topics = nlohmann::json::array();
  for (const auto& topic : reader->topics()) {
    out << "  " << base::printable(topic.name) << " (" << base::printable(topic.type)
        << "): " << topic.messages << "\n";
    topics.push_back({{"topic", topic.name}, {"type", topic.type}, {"messages", topic.messages}});
  }
  writeJson(common_.json, {{"topics", topics}, {"problem", reader->problem()}});
  return finish(reader->problem(), reader->problem().empty(), base::interrupted(), err);
}

void InfoCommand::print(std::ostream& out, const sources::RawlogSource& source,
                        const ImageSummary& images) const {
  const auto& stats = source.stats();
  out << path_ << ": " << std::filesystem::file_size(path_) << " bytes\n";
  for (const auto& [name, labels] : stats.objects)
    for (const auto& [label, n] : labels)
      out << "  " << name << (label.empty() ? "" : " ") << (label.empty() ? "" : base::quoted(label)) << ": "
          << n << "\n";
  if (images.images > 0) {
    out << "  images: " << images.images;
    for (const auto& [size, n] : images.sizes)
      out << ", " << size << (images.sizes.size() > 1 ? " x" + std::to_string(n) : "");
    out << (images.stereo > 0 ? ", stereo" : "") << (images.grey > 0 ? ", grey" : ", colour") << ", "
        << fixed(images.rate(), 2) << " per second, " << images.withOdometry << " with odometry\n";
  }
  if (const auto& rig = source.calibration())
    out << "  calibrated stereo camera, baseline " << fixed(rig->T_left_right().translation().norm(), 4)
        << " m\n";
  else if (images.stereo > 0)
    out << "  stereo camera without calibration" << (rig_ ? "" : ": give one with --camera to check the eyes")
        << "\n";
  if (stats.odometry > 0)
    out << "  odometry: " << stats.odometry << " readings, path " << fixed(stats.pathLength, 2) << " m\n";
  if (stats.lastStamp > stats.firstStamp)
    out << "  time: " << fixed(stats.lastStamp - stats.firstStamp, 2) << " s\n";
}

nlohmann::json InfoCommand::figures(const sources::RawlogStats& stats, const ImageSummary& images) const {
  return {{"bytes", std::filesystem::file_size(path_)},
          {"objects", stats.objects},
          {"cameras", stats.cameras},
          {"images", images.images},
          {"image_sizes", images.sizes},
          {"images_per_second", images.rate()},
          {"images_with_odometry", images.withOdometry},
          {"images_damaged", stats.imagesDamaged},
          {"images_missing", stats.imagesMissing},
          {"images_bad_stamp", stats.imagesBadStamp},
          {"odometry", stats.odometry},
          {"odometry_bad", stats.odometryBad},
          {"odometry_wild", stats.odometryWild},
          {"odometry_bad_stamp", stats.odometryBadStamp},
          {"path_m", stats.pathLength},
          {"first_stamp", stats.firstStamp},
          {"last_stamp", stats.lastStamp}};
}

}  // namespace

std::unique_ptr<Program> makeInfoCommand() { return std::make_unique<InfoCommand>(); }

}  // namespace engram::apps
