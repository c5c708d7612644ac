// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/progress.h"
#include "engram/sources/image_folder_source.h"
#include "engram/sources/odometry_track.h"
#include "engram/sources/rawlog_source.h"
#include "rawlog_program.h"

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include <cstdio>
#include <filesystem>
#include <ostream>
#include <set>
#include <vector>

namespace engram::apps {
namespace {

namespace fs = std::filesystem;

/// Whether a name can stand in frames.csv as it is.
bool isPlain(const std::string& name) {
  return name.find_first_of(",\"") == std::string::npos && name.front() != '#' && name.front() != ' ' &&
         name.back() != ' ';
}

class UnpackCommand final : public Program {
 public:
  std::string name() const override { return "unpack"; }
  std::string description() const override {
    return "Rawlog to image folder and frames.csv, which pack reads again";
  }
  std::string examples() const override {
    return "  engram-rawlog unpack walk.rawlog --out walk\n"
           "  engram-rawlog pack --images walk --csv walk/frames.csv --out again.rawlog\n";
  }
  void declare(CLI::App& app) override {
    app.add_option("rawlog", path_, "Rawlog to read, gzip or plain")->required();
    app.add_option("--out", folder_, "Folder to make")->required()->type_name("DIR");
    app.add_option("--format", format_, "Of the images: png keeps every pixel, jpg is smaller")
        ->check(CLI::IsMember({"png", "jpg"}))
        ->capture_default_str();
    app.add_flag("--overwrite", overwrite_, "Write into a folder that exists and is not empty");
    app.add_option("--sensor-label", params_.sensor_label, "Camera to unpack; default: the first one");
    app.add_option("--images-dir", params_.images_dir, "Folder of images stored outside")->type_name("DIR");
    common_.declare(app);
  }
  int run(std::ostream& out, std::ostream& err) override;

 private:
  void writeImage(const std::string& name, const cv::Mat& image) const;
  std::string nameOf(const types::Frame& frame);
  std::string unpackFrame(const types::Frame& frame);

  CommonOptions common_;
  std::string path_, folder_, format_ = "png";
  bool overwrite_ = false;
  sources::RawlogParams params_;
  std::set<std::string> taken_;  // names without extension
};

void UnpackCommand::writeImage(const std::string& name, const cv::Mat& image) const {
  // Not imwrite(), which does not notice a full disk.
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode("." + format_, image, bytes, {cv::IMWRITE_JPEG_QUALITY, 95}))
    throw base::Error(name + ": cannot be encoded as " + format_);
  base::writeText((fs::path(folder_) / name).string(),
                  {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, true, base::Sync::kLater);
}

/// The name of the file that was packed, so that truth finds it again, or a running number; without
/// extension. A rawlog comes from anywhere: its names do not lead out of the folder.
std::string UnpackCommand::nameOf(const types::Frame& frame) {
  char number[32];
  std::snprintf(number, sizeof number, "%06llu", static_cast<unsigned long long>(frame.index));
  const fs::path file = fs::path(frame.label).filename();
  std::string name = sources::isImageName(file) ? file.stem().string() : number;
  if (!isPlain(name)) name = number;
  if (taken_.contains(name) || taken_.contains(name + "_right")) name = std::string(number) + "_" + name;
  taken_.insert(name);
  if (!frame.right.empty()) taken_.insert(name + "_right");
  return name;
}

/// Writes the images; returns the line of the CSV.
std::string UnpackCommand::unpackFrame(const types::Frame& frame) {
  char text[160];
  const std::string name = nameOf(frame);
  const std::string left = name + "." + format_;
  const std::string right = frame.right.empty() ? "" : name + "_right." + format_;
  writeImage(left, frame.image);
  if (!right.empty()) writeImage(right, frame.right);
  std::snprintf(text, sizeof text, ",%.7f,", frame.stamp);
  std::string line = left + text + right;
  if (!frame.T_odom_robot) return line + ",,,\n";
  const types::Pose2 pose = types::toPose2(*frame.T_odom_robot);
  std::snprintf(text, sizeof text, ",%.9g,%.9g,%.9g\n", pose.x, pose.y, pose.heading);
  return line + text;
}

int UnpackCommand::run(std::ostream& out, std::ostream& err) {
  base::requireWritable(common_.json);
  if (fs::exists(folder_) && !fs::is_directory(folder_))
    throw base::Error(folder_ + ": exists and is not a folder");
  if (!overwrite_ && fs::exists(folder_) && !fs::is_empty(folder_))
    throw base::Error(folder_ + ": exists and is not empty; choose another name or give --overwrite");
  const auto source = sources::openRawlog(path_, params_);
  auto frame = source->next();
  if (!frame) throw base::Error(source->problem());
  makeFolder(folder_, {"frames.csv"});
  std::string csv = "image,stamp,right,x,y,yaw\n";
  std::size_t images = 0;
  {
    base::Progress progress(common_.progressTo(err), "unpack");
    for (; frame; frame = base::interrupted() ? std::nullopt : source->next()) {
      csv += unpackFrame(*frame);
      progress.update(source->progress(), ++images);
    }
  }
  base::syncDisk(folder_);
  base::writeText((fs::path(folder_) / "frames.csv").string(), csv, true);
  out << folder_ << ": " << images << " images and frames.csv\n";
  writeJson(common_.json, {{"images", images}, {"damage", source->damage()}, {"problem", source->problem()}});
  return finish(source->problem(), source->whole(), base::interrupted(), err);
}

}  // namespace

std::unique_ptr<Program> makeUnpackCommand() { return std::make_unique<UnpackCommand>(); }

}  // namespace engram::apps
