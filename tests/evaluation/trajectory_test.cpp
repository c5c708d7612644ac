// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/trajectory.h"

#include "engram/base/error.h"
#include "engram/base/rng.h"
#include "engram/evaluation/trajectory_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <unistd.h>

namespace engram::evaluation {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::HasSubstr;
using testing::ThrowsMessage;

Isometry3d randomPose(base::Rng& rng, double reach = 10) {
  const Vector3d axis = Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = AngleAxisd(rng.uniform(-3, 3), axis).toRotationMatrix();
  pose.translation() = reach * Vector3d(rng.normal(), rng.normal(), rng.normal());
  return pose;
}

Trajectory randomTrajectory(base::Rng& rng, int n) {
  Trajectory trajectory;
  for (int i = 0; i < n; ++i) trajectory.push_back({0.1 * i, randomPose(rng)});
  return trajectory;
}

Trajectory moved(const Trajectory& trajectory, const Isometry3d& T) {
  Trajectory out = trajectory;
  for (auto& pose : out) pose.T_world_body = T * pose.T_world_body;
  return out;
}

TEST(Tum, RoundTrip) {
  base::Rng rng(1);
  auto trajectory = randomTrajectory(rng, 20);
  for (auto& pose : trajectory) pose.stamp += 1403715273.0;
  std::ostringstream out;
  writeTum(out, trajectory);
  const auto back = parseTum(out.str(), "text");
  ASSERT_EQ(back.size(), trajectory.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_NEAR(back[i].stamp, trajectory[i].stamp, 1e-6);
    EXPECT_TRUE(back[i].T_world_body.isApprox(trajectory[i].T_world_body, 1e-8));
  }
}

/// Poses as data sets ship them, all of the same trajectory.
TEST(Poses, OfEurocTumAndKittiAreTheSame) {
  base::Rng rng(2);
  const auto truth = randomTrajectory(rng, 5);
  std::ostringstream tum, euroc, kitti, matrix, times;
  writeTum(tum, truth);
  euroc << "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z "
           "[], v\n";
  for (auto* out : {&euroc, &kitti, &matrix}) out->precision(15);
  for (const auto& pose : truth) {
    const Eigen::Quaterniond q(pose.T_world_body.linear());
    const Vector3d t = pose.T_world_body.translation();
    euroc << 1403715273000000000 + std::llround(pose.stamp * 1e9) << ',' << t.x() << ',' << t.y() << ','
          << t.z() << ',' << q.w() << ',' << q.x() << ',' << q.y() << ',' << q.z() << ",0.1\n";
    for (int i = 0; i < 12; ++i) kitti << pose.T_world_body.matrix()(i / 4, i % 4) << (i < 11 ? ' ' : '\n');
    for (int i = 0; i < 16; ++i) matrix << pose.T_world_body.matrix()(i / 4, i % 4) << (i < 15 ? ' ' : '\n');
    times << pose.stamp << '\n';
  }
  for (const std::string& text : {tum.str(), euroc.str(), kitti.str(), matrix.str()}) {
    const auto read = parsePoses(text, "text");
    ASSERT_EQ(read.size(), truth.size());
    for (std::size_t i = 0; i < read.size(); ++i)
      EXPECT_TRUE(read[i].T_world_body.isApprox(truth[i].T_world_body, 1e-8)) << text;
  }
  EXPECT_NEAR(parsePoses(euroc.str(), "text")[1].stamp, 1403715273.1, 1e-6);
  EXPECT_EQ(parsePoses(kitti.str(), "text")[2].stamp, 2.0) << "one second apart without times.txt";

  const auto folder = std::filesystem::temp_directory_path() / ("engram_poses_" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  std::ofstream(folder / "00.txt") << kitti.str();
  std::ofstream(folder / "times.txt") << times.str();
  EXPECT_NEAR(readPoses((folder / "00.txt").string())[3].stamp, truth[3].stamp, 1e-6);
  std::ofstream(folder / "times.txt", std::ios::app) << "9\n";
  EXPECT_THAT([&] { readPoses((folder / "00.txt").string()); },
              ThrowsMessage<base::Error>(HasSubstr("times.txt: has 6 stamps")));
  std::filesystem::remove_all(folder);
}

TEST(Poses, ThatAreNoneAreNamed) {
  EXPECT_FALSE(isPoseLine("query,first,last"));
  EXPECT_FALSE(isPoseLine("1 2 3"));
  EXPECT_THAT([] { parsePoses("1 0 0 0 0 2 0 0 0 0 1 0\n", "k.txt"); },
              ThrowsMessage<base::Error>(HasSubstr("k.txt:1: the matrix is not a pose")));
  EXPECT_THAT([] { parsePoses("1.5,0,0,0,1,0,0,0\n", "e.csv"); },
              ThrowsMessage<base::Error>(HasSubstr("e.csv:1: stamp [ns] '1.5' is not a whole number")));
}

TEST(Tum, ReadsTheOrderOfTheQuaternion) {
  const double h = std::sqrt(0.5);
  const auto t = parseTum("1 2 3 4 0 0 " + std::to_string(h) + " " + std::to_string(h) + "\n", "f");
  EXPECT_TRUE(t[0].T_world_body.translation().isApprox(Vector3d(2, 3, 4)));
  EXPECT_TRUE((t[0].T_world_body.linear() * Vector3d::UnitX()).isApprox(Vector3d::UnitY(), 1e-6));
}

TEST(Tum, AnyEditorMayHaveWrittenIt) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const auto t = parseTum(
        "\xEF\xBB\xBF"
        "1 2 3 4 0 0 0 1" +
            end + "# c" + end + "2 5 6 7 0 0 0 1",
        "f");
    ASSERT_EQ(t.size(), 2u);
    EXPECT_TRUE(t[0].T_world_body.translation().isApprox(Vector3d(2, 3, 4)));
    EXPECT_TRUE(t[1].T_world_body.translation().isApprox(Vector3d(5, 6, 7)));
  }
  EXPECT_THAT([] { readTum("/tmp"); }, ThrowsMessage<base::Error>(HasSubstr("/tmp: is a folder")));
}

TEST(Tum, RefusesWithFileAndLine) {
  const auto refuses = [](const std::string& text, const std::string& message) {
    EXPECT_THAT([&] { parseTum(text, "f.tum"); }, ThrowsMessage<base::Error>(HasSubstr(message)));
  };
  refuses("# nothing\n", "f.tum: holds no poses");
  refuses("1 0 0 0 0 0 0\n", "f.tum:1: expected 8 numbers (stamp x y z qx qy qz qw), found 7");
  refuses("1 0 0 a 0 0 0 1\n", "f.tum:1: z 'a' is not a number");
  refuses("1 0 0 nan 0 0 0 1\n", "f.tum:1: z 'nan' is not a number");
  refuses("1 0 0 0 0 0 0 2\n", "f.tum:1: the quaternion is not of unit length");
  refuses("1 0 0 0 0 0 0 1\n# c\n1 0 0 0 0 0 0 1\n", "f.tum:3: the stamp is not later than the one before");
  EXPECT_THAT([] { readTum("/nowhere.tum"); },
              ThrowsMessage<base::Error>(HasSubstr("/nowhere.tum: cannot be opened")));
}

TEST(PoseAt, InterpolatesAlongTheScrewOfAConstantTurn) {
  Trajectory t(2);
  t[0].stamp = 1;
  t[1].stamp = 1.5;
  t[1].T_world_body.translation() = Vector3d(1, 2, 0);
  t[1].T_world_body.linear() = AngleAxisd(1.0, Vector3d::UnitZ()).toRotationMatrix();
  const auto pose = poseAt(t, 1.1);
  ASSERT_TRUE(pose);
  EXPECT_TRUE(pose->translation().isApprox(Vector3d(0.2, 0.4, 0), 1e-9));
  EXPECT_TRUE(pose->linear().isApprox(AngleAxisd(0.2, Vector3d::UnitZ()).toRotationMatrix(), 1e-9));
}

TEST(PoseAt, KnowsItsEndsAndItsGaps) {
  Trajectory t(3);
  t[0].stamp = 1;
  t[1].stamp = 2;
  t[2].stamp = 9;
  EXPECT_FALSE(poseAt(t, 0.99));
  EXPECT_TRUE(poseAt(t, 0.9995));
  EXPECT_TRUE(poseAt(t, 1.0));
  EXPECT_TRUE(poseAt(t, 1.5));
  EXPECT_FALSE(poseAt(t, 5)) << "a gap of 7 s";
  EXPECT_TRUE(poseAt(t, 5, 10.0));
  EXPECT_TRUE(poseAt(t, 9.0005));
  EXPECT_FALSE(poseAt(t, 9.01));
  EXPECT_FALSE(poseAt({}, 1.0));
}

TEST(Ate, IsZeroForTheSameTrajectoryInAnotherFrame) {
  base::Rng rng(2);
  for (int trial = 0; trial < 20; ++trial) {
    const auto truth = randomTrajectory(rng, 30);
    const Isometry3d T = randomPose(rng);
    const auto error = ate(moved(truth, T.inverse()), truth);
    ASSERT_TRUE(error);
    EXPECT_NEAR(error->rmse, 0, 1e-9);
    EXPECT_TRUE(error->T_truth_estimate.isApprox(T, 1e-9));
    EXPECT_NEAR(error->scale, 1, 1e-12);
    EXPECT_GT(ate(moved(truth, T.inverse()), truth, Alignment::kNone)->rmse, 0.1);
  }
}

TEST(Ate, FindsTheScaleOnlyWhereItIsFree) {
  base::Rng rng(3);
  const auto truth = randomTrajectory(rng, 30);
  auto small = truth;
  for (auto& pose : small) pose.T_world_body.translation() *= 0.25;
  EXPECT_NEAR(ate(small, truth, Alignment::kSim3)->rmse, 0, 1e-9);
  EXPECT_NEAR(ate(small, truth, Alignment::kSim3)->scale, 4, 1e-9);
  EXPECT_GT(ate(small, truth, Alignment::kSe3)->rmse, 1);
}

TEST(Ate, InThePlaneLeavesTiltToTheError) {
  base::Rng rng(4);
  Trajectory truth;
  for (int i = 0; i < 40; ++i) {
    StampedPose pose;
    pose.stamp = i;
    pose.T_world_body.translation() = Vector3d(rng.normal(), rng.normal(), 0);
    truth.push_back(pose);
  }
  Isometry3d turned = Isometry3d::Identity();
  turned.linear() = AngleAxisd(2.5, Vector3d::UnitZ()).toRotationMatrix();
  turned.translation() = Vector3d(3, -4, 7);
  const auto planar = ate(moved(truth, turned), truth, Alignment::kSe2);
  EXPECT_NEAR(planar->rmse, 0, 1e-9);
  EXPECT_TRUE(planar->T_truth_estimate.isApprox(turned.inverse(), 1e-9));
  Isometry3d tilted = Isometry3d::Identity();
  tilted.linear() = AngleAxisd(0.5, Vector3d::UnitX()).toRotationMatrix();
  EXPECT_GT(ate(moved(truth, tilted), truth, Alignment::kSe2)->rmse, 0.1);
  EXPECT_NEAR(ate(moved(truth, tilted), truth, Alignment::kSe3)->rmse, 0, 1e-9);
}

// No rotation and translation near the optimum does better.
TEST(Ate, IsTheLeastSquaresOptimum) {
  base::Rng rng(5);
  const auto truth = randomTrajectory(rng, 25);
  auto estimate = moved(truth, randomPose(rng));
  for (auto& pose : estimate)
    pose.T_world_body.translation() += Vector3d(rng.normal(), rng.normal(), rng.normal());
  for (const auto alignment : {Alignment::kSe2, Alignment::kSe3}) {
    const auto best = ate(estimate, truth, alignment);
    const auto aligned = moved(estimate, best->T_truth_estimate);
    EXPECT_NEAR(ate(aligned, truth, Alignment::kNone)->rmse, best->rmse, 1e-9);
    for (int trial = 0; trial < 200; ++trial) {
      const Vector3d axis = alignment == Alignment::kSe2 ? Vector3d(0, 0, rng.normal())
                                                         : Vector3d(rng.normal(), rng.normal(), rng.normal());
      Isometry3d nudge = Isometry3d::Identity();
      nudge.linear() = AngleAxisd(0.01, axis.normalized()).toRotationMatrix();
      nudge.translation() = 0.01 * Vector3d(rng.normal(), rng.normal(), rng.normal());
      EXPECT_GE(ate(moved(aligned, nudge), truth, Alignment::kNone)->rmse, best->rmse);
    }
  }
}

TEST(Ate, OfAConstantOffsetAndOfOutliersIsTheClosedForm) {
  Trajectory truth(4), estimate(4);
  for (std::size_t i = 0; i < 4; ++i) truth[i].stamp = estimate[i].stamp = static_cast<double>(i);
  estimate[3].T_world_body.translation() = Vector3d(0, 2, 0);
  const auto error = ate(estimate, truth, Alignment::kNone);
  EXPECT_NEAR(error->rmse, 1.0, 1e-12);  // sqrt(4 / 4)
  EXPECT_NEAR(error->distance.mean, 0.5, 1e-12);
  EXPECT_NEAR(error->distance.max, 2.0, 1e-12);
  EXPECT_EQ(error->distance.count, 4);
}

TEST(Ate, LeavesOutPosesWithoutTruthAndSurvivesFewPoints) {
  Trajectory truth(2), estimate(3);
  truth[1].stamp = 1;
  estimate[0].stamp = 0.5;
  estimate[0].T_world_body.translation() = Vector3d(5, 5, 5);
  estimate[1].stamp = 7;
  estimate[2].stamp = 8;
  for (const auto alignment : {Alignment::kSe2, Alignment::kSe3, Alignment::kSim3}) {
    const auto error = ate(estimate, truth, alignment);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->distance.count, 1);
    EXPECT_NEAR(error->rmse, 0, 1e-12);
  }
  estimate.erase(estimate.begin());
  EXPECT_FALSE(ate(estimate, truth));
  EXPECT_FALSE(rpe(estimate, truth));
}

TEST(Ate, OfAStraightLineIsZeroThoughItsRollIsFree) {
  Trajectory truth;
  for (int i = 0; i < 10; ++i) {
    StampedPose pose;
    pose.stamp = i;
    pose.T_world_body.translation() = Vector3d(i, 2 * i, 0);
    truth.push_back(pose);
  }
  base::Rng rng(6);
  const auto error = ate(moved(truth, randomPose(rng)), truth);
  EXPECT_NEAR(error->rmse, 0, 1e-9);
  EXPECT_NEAR(error->T_truth_estimate.linear().determinant(), 1, 1e-9);
}

TEST(Rpe, DoesNotDependOnTheFrameAndMeasuresTheDriftOfEachStep) {
  Trajectory truth, estimate;
  const double drift = 0.02;
  for (int i = 0; i < 20; ++i) {
    StampedPose was, is;
    was.stamp = is.stamp = i;
    was.T_world_body.translation() = Vector3d(i, 0, 0);
    is.T_world_body.translation() = Vector3d(1.1 * i, 0, 0);
    was.T_world_body.linear().setIdentity();
    truth.push_back(was);
    estimate.push_back(is);
  }
  base::Rng rng(7);
  const auto error = rpe(moved(estimate, randomPose(rng)), truth, 3);
  EXPECT_NEAR(error->translationRmse, 0.3, 1e-9);
  EXPECT_NEAR(error->rotationRmse, 0, 1e-7);
  EXPECT_EQ(error->translation.count, 17);
  for (int i = 0; i < 20; ++i)
    estimate[static_cast<std::size_t>(i)].T_world_body.linear() =
        AngleAxisd(drift * i, Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_NEAR(rpe(estimate, truth, 1)->rotationRmse, drift, 1e-9);
  EXPECT_THROW(rpe(estimate, truth, 0), std::invalid_argument);
}

}  // namespace
}  // namespace engram::evaluation
