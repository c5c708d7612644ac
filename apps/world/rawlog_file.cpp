// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "rawlog_file.h"

#include "engram/base/atomic_file.h"
#include "engram/sources/mrpt_camera.h"

#include <mrpt/io/CMemoryStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>
#include <opencv2/imgcodecs.hpp>

#include <cerrno>
#include <cmath>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <vector>
#include <zlib.h>

namespace engram::apps {
namespace {

namespace fs = std::filesystem;
constexpr int kJpegQuality = 90;

[[noreturn]] void failWriting(const std::string& path) {
  throw base::Error(path + ": cannot be written: " + base::reasonOf(errno));
}

mrpt::Clock::time_point timeOf(double stamp) { return mrpt::Clock::fromDouble(stamp); }

mrpt::poses::CPose3D poseOf(const Eigen::Isometry3d& T) {
  return mrpt::poses::CPose3D(mrpt::math::CMatrixDouble44(T.matrix()));
}

}  // namespace

std::string imagesFolder(const std::string& rawlog) {
  const fs::path file(rawlog);
  return (file.parent_path() / (file.stem().string() + "_Images")).string();
}

class RawlogFile::Impl {
 public:
  Impl(const std::string& path, const world::Session& session, RawlogLayout layout, bool external)
      : path_(path),
        output_(path, true),
        folder_(imagesFolder(path)),
        session_(session),
        layout_(layout),
        external_(external) {
    mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(false);  // the default stores raw pixels, ten times as large
    mrpt::img::CImage::SERIALIZATION_JPEG_QUALITY(kJpegQuality);
    if (external_) {
      folderPart_ = base::temporaryBeside(folder_);
      if (::mkdir(folderPart_.c_str(), 0777) != 0) failWriting(folder_);
    }
    errno = 0;
    // The images are compressed already.
    file_ = gzdopen(::fcntl(output_.descriptor(), F_DUPFD_CLOEXEC, 0), "wb1");
    if (!file_) failWriting(path_);
  }

  ~Impl() {
    if (file_) gzclose(file_);
    std::error_code ignored;
    if (!folderPart_.empty()) fs::remove_all(folderPart_, ignored);
  }

  void add(std::size_t i, const types::Frame& frame) {
    const auto image = frame.right.empty() ? mono(i, frame) : stereo(i, frame);
    if (layout_ == RawlogLayout::kObservations) {
      writeOdometry(session_.drive().imageTimes()[i]);
      write(*image);
      return;
    }
    mrpt::obs::CActionCollection actions;
    mrpt::obs::CActionRobotMovement2D move;
    const world::Pose2 now = session_.drive().odometryAt(session_.drive().imageTimes()[i]);
    const world::Pose2 step = between(last_, now);
    move.timestamp = timeOf(frame.stamp);
    move.computeFromOdometry({step.x, step.y, step.heading}, {});
    actions.insert(move);
    last_ = now;
    mrpt::obs::CSensoryFrame frames;
    frames.insert(image);
    write(actions);
    write(frames);
  }

  void close() {
    if (layout_ == RawlogLayout::kObservations) writeOdometry(1e18);
    gzFile file = file_;
    file_ = nullptr;
    errno = 0;
    if (gzclose(file) != Z_OK) failWriting(path_);
    if (external_) nameFolder();
    output_.commit();
  }

 private:
  void nameFolder() {
    base::syncDisk(folderPart_);
    std::error_code error;
    fs::remove_all(folder_, error);
    fs::rename(folderPart_, folder_, error);
    if (error) throw base::Error(folder_ + ": cannot be written: " + error.message());
    folderPart_.clear();
  }

  // Serialised in memory first: MRPT's own file stream loses the errors of the last block.
  void write(const mrpt::serialization::CSerializable& object) {
    mrpt::io::CMemoryStream memory;
    auto archive = mrpt::serialization::archiveFrom(memory);
    archive.WriteObject(&object);
    const auto n = static_cast<unsigned>(memory.getTotalBytesCount());
    errno = 0;
    if (gzwrite(file_, memory.getRawBufferData(), n) != static_cast<int>(n)) failWriting(path_);
  }

  void writeOdometry(double until) {
    const auto& ticks = session_.drive().odometry();
    for (; tick_ < ticks.size() && ticks[tick_].t <= until; ++tick_) {
      mrpt::obs::CObservationOdometry o;
      o.timestamp = timeOf(session_.startStamp() + ticks[tick_].t);
      o.sensorLabel = "ODOMETRY";
      o.odometry = {ticks[tick_].pose.x, ticks[tick_].pose.y, ticks[tick_].pose.heading};
      write(o);
    }
  }

  void setImage(mrpt::img::CImage& to, const cv::Mat& from, std::size_t i, const std::string& suffix) {
    if (!external_) {
      to = mrpt::img::CImage(from, mrpt::img::SHALLOW_COPY);
      return;
    }
    char name[64];
    std::snprintf(name, sizeof name, "CAMERA_%06zu%s.jpg", i, suffix.c_str());
    std::vector<unsigned char> jpeg;
    cv::imencode(".jpg", from, jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
    base::writeText(folderPart_ + "/" + name, {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()},
                    false, base::Sync::kLater);
    to.setExternalStorage(name);
  }

  mrpt::obs::CObservation::Ptr mono(std::size_t i, const types::Frame& frame) {
    auto o = mrpt::obs::CObservationImage::Create();
    o->timestamp = timeOf(frame.stamp);
    o->sensorLabel = "CAMERA";
    o->cameraPose = poseOf(session_.eyes().left.T_robot_cam);
    o->cameraParams = sources::toMrptCamera(session_.eyes().left);
    setImage(o->image, frame.image, i, "");
    return o;
  }

  mrpt::obs::CObservation::Ptr stereo(std::size_t i, const types::Frame& frame) {
    auto o = mrpt::obs::CObservationStereoImages::Create();
    const auto& left = session_.eyes().left;
    const auto& right = *session_.eyes().right;
    o->timestamp = timeOf(frame.stamp);
    o->sensorLabel = "CAMERA";
    o->cameraPose = mrpt::poses::CPose3DQuat(poseOf(left.T_robot_cam));
    o->rightCameraPose = mrpt::poses::CPose3DQuat(poseOf(left.T_robot_cam.inverse() * right.T_robot_cam));
    o->leftCamera = sources::toMrptCamera(left), o->rightCamera = sources::toMrptCamera(right);
    o->hasImageRight = true;
    setImage(o->imageLeft, frame.image, i, "_left");
    setImage(o->imageRight, frame.right, i, "_right");
    return o;
  }

  std::string path_;
  base::OutputFile output_;
  std::string folder_, folderPart_;
  const world::Session& session_;
  RawlogLayout layout_;
  bool external_;
  gzFile file_ = nullptr;
  std::size_t tick_ = 0;
  world::Pose2 last_;
};

RawlogFile::RawlogFile(const std::string& path, const world::Session& session, RawlogLayout layout,
                       bool externalImages)
    : impl_(std::make_unique<Impl>(path, session, layout, externalImages)) {}
RawlogFile::~RawlogFile() = default;
void RawlogFile::add(std::size_t i, const types::Frame& frame) { impl_->add(i, frame); }
void RawlogFile::close() { impl_->close(); }

}  // namespace engram::apps
