// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
// engram-eval odometry and engram-rawlog info on rawlogs of a simulated stereo camera, sound and with faults.
#include "engram/apps/program.h"
#include "engram/evaluation/trajectory.h"
#include "engram/sources/rawlog_writer.h"
#include "odometry/odometry_command.h"
#include "program_run.h"
#include "rawlog_fixture.h"
#include "rawlog_program.h"
#include "world_pairs.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <optional>

namespace engram::apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using namespace odometry::testing_world;

constexpr int kFrames = 44;
constexpr double kRate = 10;  // [Hz]

/// A head with lenses, as its cameras see the office: not rectified.
const std::vector<Shown>& seen() {
  static const auto shown = driveThroughOffice(crookedRig(), kFrames, 0.06, 3);
  return shown;
}

/// engram-eval with this one experiment.
class OdometryProgram final : public Program {
 public:
  std::string name() const override { return "engram-eval"; }
  std::string description() const override { return "test"; }
  std::string examples() const override { return ""; }
  void declare(CLI::App& app) override { command_.declare(app); }
  int run(std::ostream& out, std::ostream& err) override { return command_.run(out, err); }

 private:
  OdometryCommand command_;
};

/// What a rectified head sees there.
const std::vector<Shown>& seenLevel() {
  static const auto shown = driveThroughOffice(smallRig(), 24, 0.06, 3);
  return shown;
}

class EvalOdometry : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path(name); }
  nlohmann::json json(const std::string& name) const {
    std::ifstream in(path(name));
    return nlohmann::json::parse(in);
  }

  /// The pairs, each changed by `change(i, pair)`, as a rawlog, with this calibration in it.
  template <class Change>
  std::string record(const std::string& name, const std::optional<cameras::StereoRig>& rig, Change change,
                     const std::vector<Shown>& shown = seen()) const {
    sources::RawlogWriterParams params;
    params.stereo = rig;
    sources::RawlogWriter writer(path(name), params);
    for (int i = 0; i < static_cast<int>(shown.size()); ++i) {
      types::StereoPair pair = shown[static_cast<std::size_t>(i)].raw;
      change(i, pair);
      types::Frame frame;
      frame.index = static_cast<std::uint64_t>(i);
      frame.stamp = sources::test::kStart + i / kRate;
      frame.image = pair.left;
      frame.right = pair.right;
      writer.add(frame);
    }
    writer.close();
    return path(name);
  }
  std::string record(const std::string& name) const {
    return record(name, crookedRig(), [](int, types::StereoPair&) {});
  }
  std::string writeTruth() const {
    std::ofstream out(path("truth.tum"));
    evaluation::Trajectory truth;
    for (int i = 0; i < kFrames; ++i)
      truth.push_back({sources::test::kStart + i / kRate, seen()[static_cast<std::size_t>(i)].T_world_robot});
    evaluation::writeTum(out, truth);
    return path("truth.tum");
  }

  /// Both programs say what is wrong, and that not all is well.
  void expectFault(const std::string& rawlog, const std::string& fault, const std::string& message) const {
    const auto eval = runAs<OdometryProgram>({"--rawlog", rawlog, "--json", path(fault + ".json"), "-q"});
    EXPECT_EQ(eval.code, kPartial);
    EXPECT_THAT(eval.err, AllOf(HasSubstr(rawlog), HasSubstr(message)));
    EXPECT_EQ(json(fault + ".json")["camera_check"]["fault"], fault);
    const auto info = runAs<RawlogProgram>({"info", rawlog, "--json", path(fault + "2.json"), "-q"});
    EXPECT_EQ(info.code, kPartial);
    EXPECT_THAT(info.err, AllOf(HasSubstr(rawlog), HasSubstr(message)));
    EXPECT_EQ(json(fault + "2.json")["stereo_check"]["fault"], fault);
  }

 private:
  sources::test::TempFolder folder_;
};

TEST_F(EvalOdometry, MeasuresTheDriftOfADrive) {
  const auto rawlog = record("a.rawlog");
  const auto result = runAs<OdometryProgram>(
      {"--rawlog", rawlog, "--truth", writeTruth(), "--out", path("vo"), "--json", path("vo.json")});
  ASSERT_EQ(result.code, kOk) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("44 frames"), HasSubstr("in 1 piece"), HasSubstr("drift: ")));
  const auto figures = json("vo.json");
  EXPECT_EQ(figures["frames"], kFrames);
  EXPECT_EQ(figures["failed"], 0);
  EXPECT_NEAR(figures["true_path_m"], 0.06 * (kFrames - 1), 0.03);
  // 3.2 % and 0.05 m were measured: 320 x 240 pixels, a crooked head; tests/odometry holds the accuracy
  // itself.
  EXPECT_LT(figures["translation_percent"], 4);
  EXPECT_EQ(figures["camera_check"]["fault"], "none");
  const auto trajectory = evaluation::readTum(path("vo/trajectory.tum"));
  ASSERT_EQ(trajectory.size(), static_cast<std::size_t>(kFrames));
  const auto is = trajectory.front().T_world_body.inverse() * trajectory.back().T_world_body;
  const auto was = seen().front().T_world_robot.inverse() * seen().back().T_world_robot;
  EXPECT_LT((is.translation() - was.translation()).norm(), 0.08);

  const auto again = runAs<OdometryProgram>({"--rawlog", rawlog, "--out", path("vo")});
  EXPECT_EQ(again.code, kError);
  EXPECT_THAT(again.err, HasSubstr("--overwrite"));
  const auto info = runAs<RawlogProgram>({"info", rawlog, "-q"});
  EXPECT_EQ(info.code, kOk) << info.err;
  EXPECT_THAT(info.out, HasSubstr("calibrated stereo camera, baseline 0.09"));
}

TEST_F(EvalOdometry, OneEyeCovered) {
  const cv::Mat dark(240, 320, CV_8U, cv::Scalar(6));
  expectFault(record("r.rawlog", crookedRig(), [&](int, types::StereoPair& p) { p.right = dark; }),
              "right_blank", "the right eye shows nothing");
  expectFault(record("l.rawlog", crookedRig(), [&](int, types::StereoPair& p) { p.left = dark; }),
              "left_blank", "the left eye shows nothing");
}

TEST_F(EvalOdometry, EyesSwapped) {
  const auto swap = [](int, types::StereoPair& p) { std::swap(p.left, p.right); };
  expectFault(record("s.rawlog", smallRig(), swap, seenLevel()), "swapped", "left and right are swapped");
  // Eyes with lenses of their own are not rectified by each other's calibration.
  expectFault(record("c.rawlog", crookedRig(), swap), "rows", "are left and right swapped?");
}

TEST_F(EvalOdometry, EyesOutOfSyncByAFrame) {
  const auto rightOf = [](int i) { return seen()[static_cast<std::size_t>(std::clamp(i, 0, kFrames - 1))]; };
  expectFault(record("late.rawlog", crookedRig(),
                     [&](int i, types::StereoPair& p) { p.right = rightOf(i - 1).raw.right; }),
              "right_late", "out of step: right images fit the left ones of the frame before");
  expectFault(record("early.rawlog", crookedRig(),
                     [&](int i, types::StereoPair& p) { p.right = rightOf(i + 1).raw.right; }),
              "right_early", "out of step: right images fit the left ones of the frame after");
}

TEST_F(EvalOdometry, UnrectifiedImagesDeclaredRectified) {
  expectFault(record("raw.rawlog", smallRig(), [](int, types::StereoPair&) {}), "rows",
              "not rectified by this calibration");
}

TEST_F(EvalOdometry, WithoutCalibrationOrRightImages) {
  const auto rawlog = record("bare.rawlog", std::nullopt, [](int, types::StereoPair&) {});
  auto result = runAs<OdometryProgram>({"--rawlog", rawlog});
  EXPECT_EQ(result.code, kError);
  EXPECT_THAT(result.err, AllOf(HasSubstr("bare.rawlog: holds no calibration of a stereo camera"),
                                HasSubstr("--camera"), HasSubstr("calibrate --stereo")));
  const auto info = runAs<RawlogProgram>({"info", rawlog, "-q"});
  EXPECT_EQ(info.code, kOk);
  EXPECT_THAT(info.out, HasSubstr("stereo camera without calibration"));

  std::ofstream(path("head.ini")) << cameras::toText(crookedRig());
  result = runAs<OdometryProgram>({"--rawlog", rawlog, "--camera", path("head.ini")});
  EXPECT_EQ(result.code, kOk) << result.err;

  const auto mono =
      record("mono.rawlog", std::nullopt, [](int, types::StereoPair& p) { p.right = cv::Mat(); });
  result = runAs<OdometryProgram>({"--rawlog", mono, "--camera", path("head.ini")});
  EXPECT_EQ(result.code, kError);
  EXPECT_THAT(result.err, HasSubstr("has no right one"));
}

TEST_F(EvalOdometry, TheTwoCamerasExchangedInTheCalibration) {
  cameras::StereoRig wrong = crookedRig();
  std::swap(wrong.left, wrong.right);
  const auto rawlog = record("x.rawlog", wrong, [](int, types::StereoPair&) {});
  EXPECT_THAT(runAs<OdometryProgram>({"--rawlog", rawlog}).err, HasSubstr("exchanged in the calibration"));
  const auto info = runAs<RawlogProgram>({"info", rawlog, "-q"});
  EXPECT_EQ(info.code, kPartial);
  EXPECT_THAT(info.err, HasSubstr("exchanged in the calibration"));
}

TEST_F(EvalOdometry, TruthThatDoesNotBelong) {
  std::ofstream(path("other.tum")) << "5 0 0 0 0 0 0 1\n6 1 0 0 0 0 0 1\n";
  const auto result = runAs<OdometryProgram>({"--rawlog", record("a.rawlog"), "--truth", path("other.tum")});
  EXPECT_EQ(result.code, kError);
  EXPECT_THAT(result.err, HasSubstr("do the two belong together?"));
}

TEST_F(EvalOdometry, BothEyesCovered) {
  const cv::Mat dark(240, 320, CV_8U, cv::Scalar(6));
  const auto rawlog =
      record("dark.rawlog", crookedRig(), [&](int, types::StereoPair& p) { p.left = p.right = dark; });
  const auto result = runAs<OdometryProgram>({"--rawlog", rawlog, "--truth", writeTruth()});
  EXPECT_EQ(result.code, kError);
  EXPECT_THAT(result.err,
              HasSubstr("no motion was found; the last of 44 frames failed with too_few_corners"));
}

}  // namespace
}  // namespace engram::apps
