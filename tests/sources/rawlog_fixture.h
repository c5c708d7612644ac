// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/sources/rawlog_source.h"

#include <opencv2/core/mat.hpp>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace mrpt::serialization {
class CSerializable;
}

namespace engram::sources::test {

/// A folder that goes away with the test.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_;
};

/// A picture that differs for each number: blurred noise, so JPEG keeps it nearly.
cv::Mat picture(int number, cv::Size size = {64, 48}, int channels = 3);

/// Mean absolute difference of two images of one size and type.
double difference(const cv::Mat& a, const cv::Mat& b);

using Objects = std::vector<std::shared_ptr<mrpt::serialization::CSerializable>>;

/// A rawlog as MRPT itself writes it.
void writeWithMrpt(const std::string& path, const Objects& objects, bool gzip);

/// MRPT objects; stamps in seconds since the Unix epoch.
std::shared_ptr<mrpt::serialization::CSerializable> odometryObject(double stamp, double x, double y,
                                                                   double yaw,
                                                                   const std::string& label = "ODO");
std::shared_ptr<mrpt::serialization::CSerializable> imageObject(double stamp, const cv::Mat& image,
                                                                const std::string& label = "CAM");
std::shared_ptr<mrpt::serialization::CSerializable> externalImageObject(double stamp,
                                                                        const std::string& file);
std::shared_ptr<mrpt::serialization::CSerializable> stereoObject(double stamp, const cv::Mat& left,
                                                                 const cv::Mat& right,
                                                                 const std::string& label = "STEREO");
std::shared_ptr<mrpt::serialization::CSerializable> laserObject(double stamp);
/// An action collection with one CActionRobotMovement2D; stamp < 0: none.
std::shared_ptr<mrpt::serialization::CSerializable> actionObject(double stamp, double x, double y, double yaw,
                                                                 bool fromScanMatching = false);
std::shared_ptr<mrpt::serialization::CSerializable> sensoryFrame(const Objects& observations);

std::vector<unsigned char> readAll(const std::string& path);
void writeAll(const std::string& path, const std::vector<unsigned char>& bytes);

std::vector<types::Frame> readFrames(FrameSource& source);

/// An hour that no test result may depend on.
inline constexpr double kStart = 1700000000.0;

}  // namespace engram::sources::test
