// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/rawlog_writer.h"

#include "engram/base/error.h"
#include "engram/cameras/pinhole.h"
#include "engram/sources/odometry_track.h"
#include "rawlog_fixture.h"

#include <gmock/gmock.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/serialization/CArchive.h>
#include <opencv2/imgcodecs.hpp>

#include <cmath>
#include <csignal>
#include <limits>
#include <sys/resource.h>

namespace engram::sources::test {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

types::Frame makeFrame(int number, int channels = 3) {
  types::Frame frame;
  frame.index = static_cast<std::uint64_t>(number);
  frame.stamp = kStart + 0.1 * number;
  frame.image = picture(number, {64, 48}, channels);
  frame.T_odom_robot = types::toIsometry({0.1 * number, -0.2, 0.05 * number});
  return frame;
}

void writeFrames(const std::string& path, int n, const RawlogWriterParams& params = {}) {
  RawlogWriter writer(path, params);
  for (int i = 0; i < n; ++i) writer.add(makeFrame(i, i % 2 == 0 ? 3 : 1));
  writer.close();
}

void expectRoundTrip(const std::string& path, int n) {
  auto source = openRawlog(path);
  const auto frames = readFrames(*source);
  EXPECT_EQ(source->problem(), "");
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    const auto& frame = frames[static_cast<std::size_t>(i)];
    const types::Frame truth = makeFrame(i, i % 2 == 0 ? 3 : 1);
    EXPECT_NEAR(frame.stamp, truth.stamp, 1e-6);
    ASSERT_EQ(frame.image.type(), truth.image.type());
    EXPECT_LT(difference(frame.image, truth.image), 4.0);
    ASSERT_TRUE(frame.T_odom_robot);
    EXPECT_TRUE(frame.T_odom_robot->isApprox(*truth.T_odom_robot, 1e-9));
  }
}

TEST(RawlogWriter, RoundTripEmbedded) {
  const TempFolder folder;
  writeFrames(folder.path("a.rawlog"), 7);
  expectRoundTrip(folder.path("a.rawlog"), 7);
  EXPECT_FALSE(fs::exists(folder.path("a.rawlog.part")));
}

TEST(RawlogWriter, RoundTripExternal) {
  const TempFolder folder;
  RawlogWriterParams params;
  params.external_images = true;
  writeFrames(folder.path("a.rawlog"), 5, params);
  EXPECT_TRUE(fs::exists(folder.path("a_Images/CAMERA_000004.jpg")));
  expectRoundTrip(folder.path("a.rawlog"), 5);
}

/// The names of the files that the frames of a rawlog came from.
std::vector<std::string> labelsIn(const std::string& path) {
  std::vector<std::string> labels;
  auto source = openRawlog(path);
  for (const auto& frame : readFrames(*source)) labels.push_back(frame.label);
  EXPECT_EQ(source->problem(), "");
  return labels;
}

TEST(RawlogWriter, KeepsTheNamesOfImageFilesOnRequest) {
  const std::vector<std::string> names{"IMG_9.jpg", "cam/kitchen 2.png", "\xC3\xBC.png"};
  for (const bool external : {false, true})
    for (const bool stereo : {false, true}) {
      const TempFolder folder;
      RawlogWriterParams params;
      params.file_names = true;
      params.external_images = external;
      RawlogWriter writer(folder.path("a.rawlog"), params);
      for (std::size_t i = 0; i < names.size(); ++i) {
        types::Frame frame = makeFrame(static_cast<int>(i));
        frame.label = names[i];
        if (stereo) frame.right = picture(99);
        EXPECT_EQ(writer.addReplayable(frame).label, names[i]);
      }
      writer.close();
      EXPECT_EQ(labelsIn(folder.path("a.rawlog")), names);
    }
}

TEST(RawlogWriter, WithoutNamesTheLabelIsThatOfTheSensor) {
  const TempFolder folder;
  for (const bool wanted : {false, true}) {
    RawlogWriterParams params;
    params.file_names = wanted;
    params.overwrite = true;
    RawlogWriter writer(folder.path("a.rawlog"), params);
    for (const std::string& label :
         {std::string(wanted ? "" : "p1.png"), std::string(wanted ? "a\x1B[2Jb" : "x"),
          std::string(wanted ? 5000 : 1, 'x')}) {
      types::Frame frame = makeFrame(static_cast<int>(writer.frames()));
      frame.label = label;  // none, one that a terminal would obey, one of any length
      writer.add(frame);
    }
    writer.close();
    EXPECT_EQ(labelsIn(folder.path("a.rawlog")), std::vector<std::string>(3, "CAMERA"));
  }
}

TEST(RawlogWriter, MrptReadsTheNamesAsComments) {
  const TempFolder folder;
  RawlogWriterParams params;
  params.file_names = true;
  RawlogWriter writer(folder.path("a.rawlog"), params);
  types::Frame frame = makeFrame(1);
  frame.label = "p7.png";
  writer.add(frame);
  writer.close();
  mrpt::io::CFileGZInputStream stream(folder.path("a.rawlog"));
  auto archive = mrpt::serialization::archiveFrom(stream);
  const auto comment = std::dynamic_pointer_cast<mrpt::obs::CObservationComment>(archive.ReadObject());
  ASSERT_TRUE(comment);
  EXPECT_EQ(comment->text, "image file: p7.png");
  EXPECT_TRUE(std::dynamic_pointer_cast<mrpt::obs::CObservationOdometry>(archive.ReadObject()));
  const auto image = std::dynamic_pointer_cast<mrpt::obs::CObservationImage>(archive.ReadObject());
  ASSERT_TRUE(image);
  EXPECT_EQ(comment->timestamp, image->timestamp);

  // And as MRPT writes them again, between comments of people and another camera's image of that instant.
  mrpt::obs::CObservationComment remark, endless;
  remark.text = "image file: ";
  endless.text = std::string(100000, 'x');
  const auto copy = [](const auto& object) {
    return std::make_shared<std::decay_t<decltype(object)>>(object);
  };
  mrpt::obs::CObservationComment second = *comment;
  second.text = "image file: q8.png";
  const auto other = std::make_shared<mrpt::obs::CObservationImage>(*image);
  other->sensorLabel = "OTHER";
  writeWithMrpt(folder.path("b.rawlog"), {copy(remark), comment, copy(endless), image, copy(second), other},
                true);
  RawlogParams camera;
  for (const auto& [label, name] : {std::pair("CAMERA", "p7.png"), std::pair("OTHER", "q8.png")}) {
    camera.sensor_label = label;
    auto source = openRawlog(folder.path("b.rawlog"), camera);
    const auto frames = readFrames(*source);
    ASSERT_EQ(frames.size(), 1u) << source->problem();
    EXPECT_EQ(frames[0].label, name);
    EXPECT_EQ(source->problem(), "");
  }
}

TEST(RawlogWriter, RefusesAStampThatARawlogCannotHold) {
  const TempFolder folder;
  RawlogWriter writer(folder.path("a.rawlog"));
  for (const double stamp : {1.7e12, -2e10, std::numeric_limits<double>::quiet_NaN()}) {
    types::Frame frame = makeFrame(0);
    frame.stamp = stamp;
    EXPECT_THROW(writer.add(frame), base::Error) << stamp;
    EXPECT_TRUE(std::isnan(stampAsRecorded(stamp)));
  }
  writer.add(makeFrame(0));  // and goes on
  writer.close();
  expectRoundTrip(folder.path("a.rawlog"), 1);
  EXPECT_NEAR(stampAsRecorded(kStart + 0.123456789), kStart + 0.123456789, 1.2e-7);
}

TEST(RawlogWriter, RoundTripStereo) {
  const TempFolder folder;
  types::Frame frame = makeFrame(1, 1);
  frame.right = picture(99, {64, 48}, 1);
  RawlogWriter writer(folder.path("s.rawlog"));
  writer.add(frame);
  writer.close();
  auto source = openRawlog(folder.path("s.rawlog"));
  const auto frames = readFrames(*source);
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(source->problem(), "");
  EXPECT_LT(difference(frames[0].image, frame.image), 3.0);
  EXPECT_LT(difference(frames[0].right, frame.right), 3.0);
  EXPECT_EQ(frames[0].label, "CAMERA");
}

/// A stereo camera that is not quite parallel, with lenses.
cameras::StereoRig rig() {
  const auto eye = [](cameras::ImagePlaneParams plane) {
    return cameras::makeRig(std::make_shared<cameras::Pinhole>(cv::Size(64, 48), plane));
  };
  cameras::ImagePlaneParams left{.fx = 50, .fy = 51, .cx = 31, .cy = 25};
  left.k1 = -0.2, left.k2 = 0.03, left.p1 = 1e-3, left.p2 = -2e-3, left.k3 = 0.01;
  cameras::StereoRig rig{eye(left), eye({.fx = 52, .fy = 52, .cx = 30, .cy = 24})};
  rig.left.T_robot_cam.translation() << 0.2, 0.05, 1.1;
  rig.right.T_robot_cam = rig.left.T_robot_cam * Eigen::Translation3d(0.12, 1e-3, -2e-3) *
                          Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, 2, 3).normalized());
  return rig;
}

TEST(RawlogWriter, TheCalibrationOfAStereoCameraComesBack) {
  const TempFolder folder;
  types::Frame frame = makeFrame(1, 1);
  frame.right = picture(99, {64, 48}, 1);
  RawlogWriterParams params;
  params.stereo = rig();
  RawlogWriter writer(folder.path("s.rawlog"), params);
  writer.add(frame);
  writer.close();
  const auto source = openRawlog(folder.path("s.rawlog"));
  EXPECT_FALSE(source->calibration());
  ASSERT_TRUE(source->next());
  ASSERT_TRUE(source->calibration());
  const auto &was = *params.stereo, &is = *source->calibration();
  EXPECT_TRUE(is.left.T_robot_cam.isApprox(was.left.T_robot_cam, 1e-9));
  EXPECT_TRUE(is.T_left_right().isApprox(was.T_left_right(), 1e-9));
  EXPECT_EQ(is.left.camera->toText(), was.left.camera->toText());
  EXPECT_EQ(is.right.camera->toText(), was.right.camera->toText());
}

TEST(RawlogWriter, TheCalibrationOfOneCameraComesBack) {
  const TempFolder folder;
  RawlogWriterParams params;
  params.camera = rig().left;
  RawlogWriter writer(folder.path("c.rawlog"), params);
  types::Frame frame = makeFrame(0);
  frame.image = picture(1, {64, 48});
  writer.add(frame);
  frame = makeFrame(1);
  frame.image = picture(2, {32, 24});  // it is not for such images
  writer.add(frame);
  writer.close();
  const auto source = openRawlog(folder.path("c.rawlog"));
  ASSERT_TRUE(source->next());
  ASSERT_TRUE(source->camera());
  EXPECT_TRUE(source->camera()->T_robot_cam.isApprox(params.camera->T_robot_cam, 1e-9));
  EXPECT_EQ(source->camera()->camera->toText(), params.camera->camera->toText());
  ASSERT_TRUE(source->next());
  EXPECT_FALSE(source->camera());
}

TEST(RawlogWriter, MrptReadsWhatWeWrite) {
  const TempFolder folder;
  types::Frame stereo = makeFrame(2);
  stereo.right = picture(50);
  {
    RawlogWriter writer(folder.path("a.rawlog"));
    writer.add(makeFrame(0, 3));
    writer.add(makeFrame(1, 1));
    writer.add(stereo);
    writer.close();
  }
  mrpt::io::CFileGZInputStream stream(folder.path("a.rawlog"));
  auto archive = mrpt::serialization::archiveFrom(stream);
  for (int i = 0; i < 2; ++i) {
    const auto odometry = archive.ReadObject<mrpt::obs::CObservationOdometry>();
    EXPECT_NEAR(odometry->odometry.phi(), 0.05 * i, 1e-12);
    EXPECT_NEAR(mrpt::Clock::toDouble(odometry->timestamp), kStart + 0.1 * i, 1e-6);
    const auto image = archive.ReadObject<mrpt::obs::CObservationImage>();
    EXPECT_EQ(image->sensorLabel, "CAMERA");
    EXPECT_EQ(image->image.isColor(), i == 0);
    EXPECT_LT(difference(image->image.asCvMatRef(), picture(i, {64, 48}, i == 0 ? 3 : 1)), 4.0);
  }
  archive.ReadObject<mrpt::obs::CObservationOdometry>();
  const auto pair = archive.ReadObject<mrpt::obs::CObservationStereoImages>();
  EXPECT_TRUE(pair->hasImageRight);
  EXPECT_LT(difference(pair->imageRight.asCvMatRef(), stereo.right), 4.0);
  EXPECT_THROW(archive.ReadObject(), mrpt::serialization::CExceptionEOF);
}

TEST(RawlogWriter, SameFramesSameBytes) {
  const TempFolder folder;
  writeFrames(folder.path("a.rawlog"), 4);
  writeFrames(folder.path("b.rawlog"), 4);
  EXPECT_EQ(readAll(folder.path("a.rawlog")), readAll(folder.path("b.rawlog")));
}

TEST(RawlogWriter, NeverOverwritesUnasked) {
  const TempFolder folder;
  writeFrames(folder.path("a.rawlog"), 1);
  const auto before = readAll(folder.path("a.rawlog"));
  try {
    RawlogWriter writer(folder.path("a.rawlog"));
    FAIL() << "overwrote";
  } catch (const base::Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("exists already"));
  }
  EXPECT_EQ(readAll(folder.path("a.rawlog")), before);
  RawlogWriterParams params;
  params.overwrite = true;
  writeFrames(folder.path("a.rawlog"), 3, params);
  expectRoundTrip(folder.path("a.rawlog"), 3);
}

TEST(RawlogWriter, AbandonedLeavesNothing) {
  const TempFolder folder;
  {
    RawlogWriterParams params;
    params.external_images = true;
    RawlogWriter writer(folder.path("a.rawlog"), params);
    writer.add(makeFrame(0));
  }
  EXPECT_TRUE(fs::is_empty(folder.path("")));
}

TEST(RawlogWriter, MissingFolderIsAnError) {
  const TempFolder folder;
  EXPECT_THROW(RawlogWriter(folder.path("none/a.rawlog")), base::Error);
}

// A limit on the size of files stands for a full disk: the same errors of write(), the same path through the
// code.
TEST(RawlogWriter, FullDiskIsReported) {
  const TempFolder folder;
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const auto withLimit = [&](rlim_t bytes) -> std::string {
    const rlimit limit{bytes, old.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
    std::string message;
    try {
      RawlogWriter writer(folder.path("a.rawlog"));
      for (int i = 0; i < 40; ++i) writer.add(makeFrame(i));
      writer.close();
    } catch (const base::Error& e) {
      message = e.what();
    }
    setrlimit(RLIMIT_FSIZE, &old);
    return message;
  };
  EXPECT_EQ(withLimit(old.rlim_cur), "");
  const auto size = static_cast<rlim_t>(fs::file_size(folder.path("a.rawlog")));
  fs::remove(folder.path("a.rawlog"));
  for (const rlim_t bytes : {rlim_t{100}, size / 2, size - 10}) {
    EXPECT_THAT(withLimit(bytes), HasSubstr("cannot be written")) << bytes;
    EXPECT_TRUE(fs::is_empty(folder.path(""))) << bytes;
  }
}

/// An overflow of the count of 100 ns since 1601.
TEST(RawlogWriter, StampsThatNoRawlogCanHoldAreErrors) {
  const TempFolder folder;
  RawlogWriter writer(folder.path("a.rawlog"));
  for (const double stamp : {1e300, -1e300, 1e12, -1.2e10, static_cast<double>(NAN)}) {
    types::Frame frame = makeFrame(1);
    frame.stamp = stamp;
    EXPECT_THROW(writer.add(frame), base::Error) << stamp;
  }
  types::Frame first = makeFrame(1), last = makeFrame(2);
  first.stamp = -1.16e10, last.stamp = 8.4e11;
  EXPECT_NEAR(writer.addReplayable(first).stamp, first.stamp, 1e-5);
  EXPECT_NEAR(writer.addReplayable(last).stamp, last.stamp, 1e-4);
  writer.close();
  EXPECT_EQ(writer.frames(), 2u);
}

TEST(RawlogWriter, FrameWithoutImageIsAnError) {
  const TempFolder folder;
  RawlogWriter writer(folder.path("a.rawlog"));
  EXPECT_THROW(writer.add(types::Frame{}), base::Error);
}

}  // namespace
}  // namespace engram::sources::test
