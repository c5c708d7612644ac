// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "rawlog_fixture.h"

#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>
#include <opencv2/imgproc.hpp>

#include <fstream>
#include <unistd.h>

namespace engram::sources::test {
namespace fs = std::filesystem;
using namespace mrpt::obs;
using Object = std::shared_ptr<mrpt::serialization::CSerializable>;

namespace {

mrpt::Clock::time_point timeOf(double stamp) { return mrpt::Clock::fromDouble(stamp); }

}  // namespace

TempFolder::TempFolder() {
  std::string name = (fs::temp_directory_path() / "engram_test_XXXXXX").string();
  folder_ = mkdtemp(name.data());
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

cv::Mat picture(int number, cv::Size size, int channels) {
  cv::Mat image(size, CV_8UC(channels));
  cv::RNG rng(static_cast<std::uint64_t>(number) + 1);
  rng.fill(image, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(image, image, {}, 4.0);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  return image;
}

double difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) /
         static_cast<double>(a.total() * static_cast<std::size_t>(a.channels()));
}

void writeWithMrpt(const std::string& path, const Objects& objects, bool gzip) {
  mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(false);
  mrpt::img::CImage::SERIALIZATION_JPEG_QUALITY(95);
  const auto writeTo = [&](auto& stream) {
    auto archive = mrpt::serialization::archiveFrom(stream);
    for (const auto& object : objects) archive << *object;
  };
  if (gzip) {
    mrpt::io::CFileGZOutputStream stream(path);
    writeTo(stream);
  } else {
    mrpt::io::CFileOutputStream stream(path);
    writeTo(stream);
  }
}

Object odometryObject(double stamp, double x, double y, double yaw, const std::string& label) {
  auto object = CObservationOdometry::Create();
  object->odometry = mrpt::poses::CPose2D(x, y, yaw);
  object->timestamp = timeOf(stamp);
  object->sensorLabel = label;
  object->hasVelocities = true;
  return object;
}

Object imageObject(double stamp, const cv::Mat& image, const std::string& label) {
  auto object = CObservationImage::Create();
  object->image = mrpt::img::CImage(image, mrpt::img::DEEP_COPY);
  object->timestamp = timeOf(stamp);
  object->sensorLabel = label;
  return object;
}

Object externalImageObject(double stamp, const std::string& file) {
  auto object = CObservationImage::Create();
  object->image.setExternalStorage(file);
  object->timestamp = timeOf(stamp);
  object->sensorLabel = "CAM";
  return object;
}

Object stereoObject(double stamp, const cv::Mat& left, const cv::Mat& right, const std::string& label) {
  auto object = CObservationStereoImages::Create();
  object->imageLeft = mrpt::img::CImage(left, mrpt::img::DEEP_COPY);
  object->imageRight = mrpt::img::CImage(right, mrpt::img::DEEP_COPY);
  object->hasImageRight = true;
  object->timestamp = timeOf(stamp);
  object->sensorLabel = label;
  return object;
}

Object laserObject(double stamp) {
  auto object = CObservation2DRangeScan::Create();
  object->resizeScan(181);
  for (int i = 0; i < 181; ++i) {
    object->setScanRange(static_cast<std::size_t>(i), 1.0f + 0.01f * static_cast<float>(i));
    object->setScanRangeValidity(static_cast<std::size_t>(i), true);
  }
  object->timestamp = timeOf(stamp);
  object->sensorLabel = "LASER";
  return object;
}

Object actionObject(double stamp, double x, double y, double yaw, bool fromScanMatching) {
  CActionRobotMovement2D movement;
  movement.computeFromOdometry(mrpt::poses::CPose2D(x, y, yaw), {});
  if (fromScanMatching) movement.estimationMethod = CActionRobotMovement2D::emScan2DMatching;
  movement.timestamp = stamp < 0 ? INVALID_TIMESTAMP : timeOf(stamp);
  auto object = CActionCollection::Create();
  object->insert(movement);
  return object;
}

Object sensoryFrame(const Objects& observations) {
  auto object = CSensoryFrame::Create();
  for (const auto& o : observations) object->insert(std::dynamic_pointer_cast<CObservation>(o));
  return object;
}

std::vector<unsigned char> readAll(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void writeAll(const std::string& path, const std::vector<unsigned char>& bytes) {
  std::error_code ignored;
  fs::remove(
      path,
      ignored);  // some file systems flush a file that is truncated and written anew, thousands of times
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

std::vector<types::Frame> readFrames(FrameSource& source) {
  std::vector<types::Frame> frames;
  while (auto frame = source.next()) frames.push_back(std::move(*frame));
  return frames;
}

}  // namespace engram::sources::test
