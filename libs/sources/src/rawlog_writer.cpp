// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/rawlog_writer.h"

#include "engram/base/output_file.h"
#include "engram/sources/mrpt_camera.h"
#include "engram/sources/odometry_track.h"
#include "gz_archive.h"
#include "image_codec.h"
#include "image_name.h"
#include "rawlog_stamp.h"

#include <mrpt/img/TCamera.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/poses/CPose3D.h>
#include <mrpt/poses/CPose3DQuat.h>

#include <cerrno>
#include <cmath>
#include <fcntl.h>
#include <filesystem>
#include <limits>
#include <unistd.h>
#include <vector>

namespace engram::sources {
namespace {

namespace fs = std::filesystem;

std::string imagesFolderOf(const std::string& path) {
  const fs::path file(path);
  return (file.parent_path() / (file.stem().string() + "_Images")).string();
}

void writeFile(const std::string& path, const std::vector<std::uint8_t>& bytes) {
  const int descriptor = base::openOutput(path);
  const int error = base::writeAll(descriptor, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  ::close(descriptor);
  if (error != 0) failWriting(path, error);
}

void makeFolder(const std::string& path) {
  std::error_code status;
  fs::create_directory(path, status);
  if (status) throw base::Error(path + ": cannot be made: " + status.message());
}

}  // namespace

double stampAsRecorded(double stamp) {
  return fitsRawlog(stamp) ? unixSeconds(rawlogTicks(stamp)) : std::numeric_limits<double>::quiet_NaN();
}

class RawlogWriter::Impl {
 public:
  Impl(const std::string& path, const RawlogWriterParams& params)
      : path_(path), params_(params), folder_(imagesFolderOf(path)) {
    const auto parent = fs::path(path_).parent_path();
    if (!parent.empty() && !fs::is_directory(parent)) throw base::Error(parent.string() + ": no such folder");
    const bool regular = base::isRegularOutput(path_);
    if (params_.external_images && !regular)
      throw base::Error(path_ + ": is no file that a folder of images can lie beside");
    for (const auto& target : {path_, params_.external_images ? folder_ : path_})
      if (!params_.overwrite && regular && fs::exists(target))
        throw base::Error(target + ": exists already; choose another name or allow to overwrite it");
    if (params_.external_images && fs::exists(folder_) && !fs::is_directory(folder_))
      throw base::Error(folder_ + ": is no folder; the images are to go there");
    base::requireWritable(path_);
    if (!params_.live) begin();
  }

  ~Impl() {
    if (params_.live) keepWhatIsWhole();
    out_.reset();
    std::error_code ignored;
    if (!folderPart_.empty()) fs::remove_all(folderPart_, ignored);
    if (!begun_ || !params_.live || !empty_) return;
    fs::remove(path_, ignored);
    if (params_.external_images) fs::remove_all(folder_, ignored);
  }

  void add(const types::Frame& frame) {
    if (frame.image.empty())
      throw base::Error(path_ + ": frame " + std::to_string(frame.index) + " has no image");
    if (!fitsRawlog(frame.stamp))
      throw base::Error(path_ + ": the stamp of frame " + std::to_string(frame.index) + ", " +
                        std::to_string(frame.stamp) + " s, is none that a rawlog can hold");
    writeWhole([&] {
      empty_ = false;
      label_ = frame.label;
      if (keepsName()) writeName(frame);
      if (frame.T_odom_robot) writeOdometry(frame);
      frame.right.empty() ? writeImage(frame) : writeStereo(frame);
    });
    ++frames_;
  }

  types::Frame addReplayable(const types::Frame& frame) {
    types::Frame replayed;
    replayed.index = frames_;
    add(frame);
    replayed.stamp = unixSeconds(rawlogTicks(frame.stamp));
    replayed.image = decodeAgain(left_.jpeg);
    if (!frame.right.empty()) replayed.right = decodeAgain(right_.jpeg);
    if (frame.T_odom_robot) replayed.T_odom_robot = toIsometry(pose_);
    replayed.label = params_.external_images ? left_.name : params_.sensor_label;
    if (keepsName()) replayed.label = label_;
    return replayed;
  }

  void addObject(const mrpt::serialization::CSerializable& object) {
    writeWhole([&] {
      empty_ = false;
      out_->WriteObject(&object);
    });
  }

  void flush() {
    if (begun_) writeWhole([&] { out_->flush(params_.sync); });
    framesSafe_ = frames_;
  }

  void close() {
    if (closed_) return;
    writeWhole([&] { out_->finish(); });
    framesSafe_ = frames_;
    finalBytes_ = out_->size();
    out_.reset();
    closed_ = true;
    if (params_.live) return;
    if (params_.external_images) nameFolder();
    file_->commit();
  }

  std::size_t frames() const { return frames_; }
  std::size_t framesSafe() const { return framesSafe_; }
  std::uint64_t bytes() const { return (out_ ? out_->size() : finalBytes_) + externalBytes_; }

 private:
  /// An image as it was written.
  struct Written {
    std::vector<std::uint8_t> jpeg;
    std::string name;  ///< of the file, when it lies outside
  };

  /// A live recording begins with its first object: until then an earlier one of that name stays.
  void begin() {
    begun_ = true;
    if (params_.live) {
      out_ = std::make_unique<GzArchive>(base::openOutput(path_), path_);
      if (params_.external_images) makeFolder(folder_);
      return;
    }
    file_ = std::make_unique<base::OutputFile>(path_, params_.overwrite);
    out_ = std::make_unique<GzArchive>(::fcntl(file_->descriptor(), F_DUPFD_CLOEXEC, 0), path_);
    if (!params_.external_images) return;
    folderPart_ = base::temporaryBeside(folder_);
    makeFolder(folderPart_);
  }

  /// Half an object must not stay: what follows it could not be read.
  template <class Write>
  void writeWhole(const Write& write) {
    if (closed_) throw base::Error(path_ + ": is closed already");
    if (!begun_) begin();
    try {
      write();
    } catch (...) {
      out_->cutBack();
      finalBytes_ = out_->size();
      out_.reset();
      closed_ = true;
      throw;
    }
  }

  /// The folder of an earlier rawlog goes when the new one is in its place.
  void nameFolder() {
    base::syncDisk(folderPart_);
    std::error_code status, ignored;
    const std::string old = base::temporaryBeside(folder_);
    fs::rename(folder_, old, ignored);
    fs::rename(folderPart_, folder_, status);
    if (status) {
      fs::rename(old, folder_, ignored);
      throw base::Error(folder_ + ": cannot be made: " + status.message());
    }
    folderPart_.clear();
    fs::remove_all(old, ignored);
  }

  /// The end of a live recording that was not closed: an exception passes.
  void keepWhatIsWhole() noexcept {
    if (!out_) return;
    try {
      out_->finish();
    } catch (...) {
      out_->cutBack();
    }
  }

  static cv::Mat decodeAgain(const std::vector<std::uint8_t>& jpeg) {
    EncodedImage encoded;
    encoded.kind = EncodedImage::Kind::kFile;
    encoded.bytes = jpeg;
    return decode(encoded, "").image;
  }

  bool keepsName() const { return params_.file_names && !commentOf(label_).empty(); }

  void writeName(const types::Frame& frame) {
    mrpt::obs::CObservationComment comment;
    comment.text = commentOf(frame.label);
    comment.timestamp = mrpt::Clock::time_point(mrpt::Clock::duration(rawlogTicks(frame.stamp)));
    out_->WriteObject(&comment);
  }

  void writeOdometry(const types::Frame& frame) {
    const Pose2 pose = types::toPose2(*frame.T_odom_robot);
    mrpt::obs::CObservationOdometry odometry;
    odometry.odometry = mrpt::poses::CPose2D(pose.x, pose.y, pose.heading);
    pose_ = {odometry.odometry.x(), odometry.odometry.y(), odometry.odometry.phi()};  // it wraps the angle
    odometry.sensorLabel = params_.odometry_label;
    odometry.timestamp = mrpt::Clock::time_point(mrpt::Clock::duration(rawlogTicks(frame.stamp)));
    out_->WriteObject(&odometry);
  }

  // The images are written here and not by MRPT: its JPEG switch and quality are global variables, and it
  // stores grey images uncompressed.
  void writeImage(const types::Frame& frame) {
    out_->header("mrpt::obs::CObservationImage", 4);
    const bool known = params_.camera && params_.camera->camera->imageSize() == frame.image.size();
    if (known)
      *out_ << mrpt::poses::CPose3D(mrpt::math::CMatrixDouble44(params_.camera->T_robot_cam.matrix()))
            << toMrptCamera(*params_.camera);
    else
      *out_ << mrpt::poses::CPose3D() << calibrationOf(frame.image);
    writePixels(frame.image, "", left_);
    out_->value(rawlogTicks(frame.stamp));
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
    writePixels(frame.image, "_left", left_);
    out_->value(std::uint8_t{0});  // no disparity image
    out_->value(std::uint8_t{1});  // but a right one
    writePixels(frame.right, "_right", right_);
    out_->value(rawlogTicks(frame.stamp));
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

  void writePixels(const cv::Mat& image, const std::string& suffix, Written& written) {
    written.jpeg = encodeJpeg(image, params_.jpeg_quality);
    const auto& bytes = written.jpeg;
    if (bytes.empty()) throw base::Error(path_ + ": an image cannot be encoded as JPEG");
    out_->header("mrpt::img::CImage", 8);
    out_->value(static_cast<std::uint8_t>(params_.external_images ? 1 : 0));
    if (params_.external_images) {
      written.name = externalName(suffix);
      writeFile((params_.live ? folder_ : folderPart_) + "/" + written.name, bytes);
      externalBytes_ += bytes.size();
      out_->text(written.name);
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
  std::string folder_, folderPart_;         // of the images outside
  std::unique_ptr<base::OutputFile> file_;  // unless live
  std::unique_ptr<GzArchive> out_;
  bool begun_ = false, closed_ = false;
  std::size_t frames_ = 0, framesSafe_ = 0;
  std::uint64_t finalBytes_ = 0, externalBytes_ = 0;
  bool empty_ = true;  // nothing was ever written
  std::string label_;  // of the frame being written
  Written left_, right_;
  Pose2 pose_;
};

RawlogWriter::RawlogWriter(const std::string& path, const RawlogWriterParams& params)
    : impl_(std::make_unique<Impl>(path, params)) {}
RawlogWriter::~RawlogWriter() = default;
void RawlogWriter::add(const types::Frame& frame) { impl_->add(frame); }
types::Frame RawlogWriter::addReplayable(const types::Frame& frame) { return impl_->addReplayable(frame); }
void RawlogWriter::addObject(const mrpt::serialization::CSerializable& object) { impl_->addObject(object); }
void RawlogWriter::flush() { impl_->flush(); }
void RawlogWriter::close() { impl_->close(); }
std::size_t RawlogWriter::frames() const { return impl_->frames(); }
std::size_t RawlogWriter::framesSafe() const { return impl_->framesSafe(); }
std::uint64_t RawlogWriter::bytes() const { return impl_->bytes(); }

}  // namespace engram::sources
