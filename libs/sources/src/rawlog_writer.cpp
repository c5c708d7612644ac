// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/rawlog_writer.h"

#include "engram/base/error.h"
#include "engram/sources/mrpt_camera.h"
#include "engram/sources/odometry_track.h"
#include "image_codec.h"

#include <mrpt/img/TCamera.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/poses/CPose3D.h>
#include <mrpt/poses/CPose3DQuat.h>
#include <mrpt/serialization/CArchive.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <unistd.h>
#include <vector>
#include <zlib.h>

namespace engram::sources {
namespace {

namespace fs = std::filesystem;

constexpr std::uint8_t kEndFlag = 0x88;

std::string imagesFolderOf(const std::string& path) {
  const fs::path file(path);
  return (file.parent_path() / (file.stem().string() + "_Images")).string();
}

[[noreturn]] void failWriting(const std::string& path, int error) {
  const std::string hint =
      error == ENOSPC || error == EFBIG || error == EDQUOT ? "; free some space or choose another disk" : "";
  throw base::Error(path + ": cannot be written: " + std::strerror(error) + hint);
}

std::uint64_t toTicks(double stamp) {
  return static_cast<std::uint64_t>(std::llround(stamp * 1e7) + 116444736000000000);
}

/// MRPT's archive onto a gzip file whose write errors are not lost: MRPT's own stream ignores those of the
/// last block.
class GzArchive final : public mrpt::serialization::CArchive {
 public:
  explicit GzArchive(std::string path) : path_(std::move(path)) {
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0) failWriting(path_, errno);
    file_ = gzdopen(::dup(descriptor_), "wb1");  // the images are compressed already
    if (!file_) failWriting(path_, errno);
  }
  ~GzArchive() override {
    if (file_) gzclose_w(file_);
    ::close(descriptor_);
  }

  void finish() {
    gzFile file = file_;
    file_ = nullptr;
    errno = 0;
    if (gzclose_w(file) != Z_OK || ::fsync(descriptor_) != 0) failWriting(path_, errno != 0 ? errno : EIO);
  }

  void bytes(const void* data, std::size_t n) {
    errno = 0;
    if (n > 0 && gzwrite(file_, data, static_cast<unsigned>(n)) != static_cast<int>(n))
      failWriting(path_, errno != 0 ? errno : EIO);
  }
  template <class T>
  void value(T v) {
    bytes(&v, sizeof v);
  }
  void text(const std::string& s) {
    value(static_cast<std::uint32_t>(s.size()));
    bytes(s.data(), s.size());
  }
  void header(const std::string& name, int version) {
    value(static_cast<std::uint8_t>(name.size() | 0x80));
    bytes(name.data(), name.size());
    value(static_cast<std::uint8_t>(version));
  }

 protected:
  size_t write(const void* data, size_t n) override {
    bytes(data, n);
    return n;
  }
  size_t read(void*, size_t) override { throw std::logic_error("GzArchive is for writing"); }

 private:
  std::string path_;
  int descriptor_ = -1;
  gzFile file_ = nullptr;
};

void writeFile(const std::string& path, const std::vector<std::uint8_t>& bytes) {
  errno = 0;
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) failWriting(path, errno != 0 ? errno : EIO);
}

}  // namespace

class RawlogWriter::Impl {
 public:
  Impl(const std::string& path, const RawlogWriterParams& params)
      : path_(path),
        params_(params),
        part_(path + ".part"),
        folder_(imagesFolderOf(path)),
        folderPart_(folder_ + ".part") {
    for (const auto& target : {path_, params_.external_images ? folder_ : path_})
      if (!params_.overwrite && fs::exists(target))
        throw base::Error(target + ": exists already; choose another name or allow to overwrite it");
    const auto parent = fs::path(path_).parent_path();
    if (!parent.empty() && !fs::is_directory(parent)) throw base::Error(parent.string() + ": no such folder");
    out_ = std::make_unique<GzArchive>(part_);
    if (!params_.external_images) return;
    std::error_code status;
    fs::remove_all(folderPart_, status);
    fs::create_directory(folderPart_, status);
    if (status) throw base::Error(folderPart_ + ": cannot be made: " + status.message());
  }

  ~Impl() {
    out_.reset();
    std::error_code ignored;
    fs::remove(part_, ignored);
    fs::remove_all(folderPart_, ignored);
  }

  void add(const types::Frame& frame) {
    if (!out_) throw base::Error(path_ + ": is closed already");
    if (frame.image.empty())
      throw base::Error(path_ + ": frame " + std::to_string(frame.index) + " has no image");
    label_ = frame.label;
    if (frame.T_odom_robot) writeOdometry(frame);
    frame.right.empty() ? writeImage(frame) : writeStereo(frame);
    ++frames_;
  }

  void close() {
    if (!out_) return;
    out_->finish();
    out_.reset();
    std::error_code status;
    if (params_.external_images) {
      fs::remove_all(folder_, status);
      fs::rename(folderPart_, folder_, status);
      if (status) throw base::Error(folder_ + ": cannot be made: " + status.message());
    }
    fs::rename(part_, path_, status);
    if (status) throw base::Error(path_ + ": cannot be written: " + status.message());
  }

  std::size_t frames() const { return frames_; }

 private:
  void writeOdometry(const types::Frame& frame) {
    const Pose2 pose = toPose2(*frame.T_odom_robot);
    mrpt::obs::CObservationOdometry odometry;
    odometry.odometry = mrpt::poses::CPose2D(pose.x, pose.y, pose.yaw);
    odometry.sensorLabel = params_.odometry_label;
    odometry.timestamp = mrpt::Clock::time_point(mrpt::Clock::duration(toTicks(frame.stamp)));
    out_->WriteObject(&odometry);
  }

  // The images are written here and not by MRPT: its JPEG switch and quality are global variables, and it
  // stores grey images uncompressed.
  void writeImage(const types::Frame& frame) {
    out_->header("mrpt::obs::CObservationImage", 4);
    *out_ << mrpt::poses::CPose3D() << calibrationOf(frame.image);
    writePixels(frame.image, "");
    out_->value(toTicks(frame.stamp));
    out_->text(params_.sensor_label);
    out_->value(kEndFlag);
  }

  void writeStereo(const types::Frame& frame) {
    const auto& rig = params_.stereo;
    const auto pose = [](const Eigen::Isometry3d& T) {
      return mrpt::poses::CPose3DQuat(mrpt::poses::CPose3D(mrpt::math::CMatrixDouble44(T.matrix())));
    };
    out_->header("mrpt::obs::CObservationStereoImages", 6);
    *out_ << (rig ? pose(rig->left.T_robot_cam) : mrpt::poses::CPose3DQuat())
          << (rig ? toMrptCamera(rig->left) : calibrationOf(frame.image))
          << (rig ? toMrptCamera(rig->right) : calibrationOf(frame.right));
    writePixels(frame.image, "_left");
    out_->value(std::uint8_t{0});  // no disparity image
    out_->value(std::uint8_t{1});  // but a right one
    writePixels(frame.right, "_right");
    out_->value(toTicks(frame.stamp));
    *out_ << (rig ? pose(rig->T_left_right()) : mrpt::poses::CPose3DQuat());
    out_->text(params_.sensor_label);
    out_->value(kEndFlag);
  }

  static mrpt::img::TCamera calibrationOf(const cv::Mat& image) {
    mrpt::img::TCamera camera;
    camera.ncols = static_cast<std::uint32_t>(image.cols);
    camera.nrows = static_cast<std::uint32_t>(image.rows);
    return camera;
  }

  /// Numbered, and named after the file that the image came from: truth may refer to that.
  std::string externalName(const std::string& suffix) const {
    char number[16];
    std::snprintf(number, sizeof number, "%06zu", frames_);
    const fs::path origin(label_);
    std::string name = params_.sensor_label + "_" + number + suffix;
    if (origin.has_extension()) name.append("_").append(origin.stem().string());
    return name + ".jpg";
  }

  void writePixels(const cv::Mat& image, const std::string& suffix) {
    const auto bytes = encodeJpeg(image, params_.jpeg_quality);
    if (bytes.empty()) throw base::Error(path_ + ": an image cannot be encoded as JPEG");
    out_->header("mrpt::img::CImage", 8);
    out_->value(static_cast<std::uint8_t>(params_.external_images ? 1 : 0));
    if (params_.external_images) {
      const std::string name = externalName(suffix);
      writeFile(folderPart_ + "/" + name, bytes);
      out_->text(name);
    } else {
      out_->value(std::uint8_t{1});  // "colour", which means JPEG; a grey JPEG is read back as grey
      out_->value(static_cast<std::int32_t>(image.cols));
      out_->value(static_cast<std::int32_t>(image.rows));
      out_->value(static_cast<std::uint32_t>(bytes.size()));
      out_->bytes(bytes.data(), bytes.size());
    }
    out_->value(kEndFlag);
  }

  std::string path_;
  RawlogWriterParams params_;
  std::string part_, folder_, folderPart_;
  std::unique_ptr<GzArchive> out_;
  std::size_t frames_ = 0;
  std::string label_;  // of the frame being written
};

RawlogWriter::RawlogWriter(const std::string& path, const RawlogWriterParams& params)
    : impl_(std::make_unique<Impl>(path, params)) {}
RawlogWriter::~RawlogWriter() = default;
void RawlogWriter::add(const types::Frame& frame) { impl_->add(frame); }
void RawlogWriter::close() { impl_->close(); }
std::size_t RawlogWriter::frames() const { return impl_->frames(); }

}  // namespace engram::sources
