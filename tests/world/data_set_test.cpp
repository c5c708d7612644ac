// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/rawlog_source.h"
#include "tiny_world.h"
#include "world_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <sys/wait.h>

namespace engram::apps {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class DataSet : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("engram_world_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    std::ofstream(folder_ / "small.ini") << cameras::toText(world::smallEyes("omni").left);
  }
  void TearDown() override { fs::remove_all(folder_); }

  int run(std::vector<std::string> arguments) {
    WorldProgram program;
    out_.str(""), err_.str("");
    return runProgram(program, arguments, out_, err_);
  }
  int make(const std::string& name, std::vector<std::string> more) {
    more.insert(more.begin(), {"make", "--preset", "tiny", "--camera", (folder_ / "small.ini").string(),
                               "--out", path(name), "-q"});
    return run(more);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string read(const std::string& name) const {
    std::ifstream in(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }

  fs::path folder_;
  std::ostringstream out_, err_;
};

std::vector<std::vector<double>> table(const std::string& text, char separator) {
  std::vector<std::vector<double>> rows;
  std::istringstream in(text);
  std::string line;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] == '#' || line[0] == 'i') continue;
    for (auto& c : line)
      if (c == separator) c = ' ';
    std::istringstream words(line);
    rows.emplace_back(std::istream_iterator<double>(words), std::istream_iterator<double>());
  }
  return rows;
}

TEST_F(DataSet, TruthMatchesTheRawlogImageByImage) {
  ASSERT_EQ(make("a", {"--sessions", "1", "--test-drive", "--json", path("f.json")}), 0) << err_.str();
  for (const std::string name : {"session_01", "test"}) {
    auto source = sources::openRawlog(path("a/" + name + ".rawlog"));
    const auto truth = table(read("a/" + name + ".truth.tum"), ' '),
               places = table(read("a/" + name + ".places.csv"), ',');
    std::size_t n = 0;
    Eigen::Isometry3d T_odom = Eigen::Isometry3d::Identity(), T_true = T_odom;
    while (const auto frame = source->next()) {
      ASSERT_LT(n, truth.size());
      EXPECT_NEAR(frame->stamp, truth[n][0], 1e-5);
      EXPECT_NEAR(frame->stamp, places[n][1], 1e-5);
      EXPECT_EQ(frame->image.size(), cv::Size(160, 120));
      ASSERT_TRUE(frame->T_odom_robot);
      Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
      T.translation() = Eigen::Vector3d(truth[n][1], truth[n][2], truth[n][3]);
      T.linear() = Eigen::Quaterniond(truth[n][7], truth[n][4], truth[n][5], truth[n][6]).toRotationMatrix();
      EXPECT_NEAR(places[n][3], truth[n][1], 1e-3);
      if (n > 0) {  // odometry increments are the true ones up to their noise
        const Eigen::Isometry3d error =
            (T_odom.inverse() * *frame->T_odom_robot).inverse() * (T_true.inverse() * T);
        EXPECT_LT(error.translation().norm(), 0.12) << name << " " << n;
      }
      T_odom = *frame->T_odom_robot, T_true = T;
      ++n;
    }
    EXPECT_EQ(source->problem(), "");
    EXPECT_EQ(n, truth.size());
    EXPECT_EQ(n, places.size());
  }
  const auto figures = nlohmann::json::parse(read("f.json")),
             info = nlohmann::json::parse(read("a/world.json"));
  EXPECT_EQ(figures["sessions"], 2);
  EXPECT_EQ(info["sessions"][1]["kind"], "test");
  EXPECT_EQ(info["sessions"][0]["images"], table(read("a/session_01.truth.tum"), ' ').size());
  EXPECT_EQ(info["places"], figures["places"]);
  EXPECT_EQ(cameras::loadCamera(path("a/camera.ini")).camera->imageSize(), cv::Size(160, 120));
  EXPECT_FALSE(world::loadPlan(path("a/plan.txt")).cells.empty());
}

TEST_F(DataSet, SameSeedSameFilesForAnyNumberOfThreads) {
  ASSERT_EQ(make("a", {"--sessions", "1", "--spacing", "2"}), 0) << err_.str();
  ASSERT_EQ(make("b", {"--sessions", "1", "--spacing", "2", "--threads", "2"}), 0);
  ASSERT_EQ(make("c", {"--sessions", "1", "--spacing", "2", "--seed", "9"}), 0);
  for (const char* name : {"session_01.rawlog", "session_01.truth.tum", "session_01.places.csv", "world.json",
                           "plan.png", "camera.ini"})
    EXPECT_EQ(read("a/" + std::string(name)), read("b/" + std::string(name))) << name;
  EXPECT_NE(read("a/session_01.rawlog"), read("c/session_01.rawlog"));
}

TEST_F(DataSet, AllLayoutsGiveTheSameFrames) {
  ASSERT_EQ(make("o", {"--sessions", "1", "--spacing", "2"}), 0) << err_.str();
  ASSERT_EQ(make("a", {"--sessions", "1", "--spacing", "2", "--layout", "actions"}), 0) << err_.str();
  ASSERT_EQ(make("e", {"--sessions", "1", "--spacing", "2", "--external-images"}), 0) << err_.str();
  EXPECT_TRUE(fs::exists(path("e/session_01_Images/CAMERA_000000.jpg")));
  auto o = sources::openRawlog(path("o/session_01.rawlog")),
       a = sources::openRawlog(path("a/session_01.rawlog")),
       e = sources::openRawlog(path("e/session_01.rawlog"));
  std::size_t n = 0;
  while (const auto first = o->next()) {
    const auto second = a->next(), third = e->next();
    ASSERT_TRUE(second && third);
    EXPECT_EQ(cv::norm(first->image, second->image, cv::NORM_INF), 0);
    EXPECT_LT(cv::norm(first->image, third->image, cv::NORM_L1) / static_cast<double>(first->image.total()),
              12);
    EXPECT_NEAR(first->stamp, second->stamp, 1e-5);
    if (n > 0) {
      EXPECT_LT((first->T_odom_robot->translation() - second->T_odom_robot->translation()).norm(), 0.02);
    }
    ++n;
  }
  EXPECT_GT(n, 6u);
  EXPECT_FALSE(a->next());
}

TEST_F(DataSet, RefusesWhatItCannotDo) {
  ASSERT_EQ(make("a", {"--sessions", "1", "--spacing", "5"}), 0) << err_.str();
  const std::string before = read("a/session_01.rawlog");
  EXPECT_EQ(make("a", {"--sessions", "1", "--seed", "2"}), 1);
  EXPECT_THAT(err_.str(), HasSubstr("exists already"));
  EXPECT_EQ(read("a/session_01.rawlog"), before);
  EXPECT_EQ(make("a", {"--sessions", "1", "--seed", "2", "--spacing", "5", "--overwrite"}), 0);
  EXPECT_NE(read("a/session_01.rawlog"), before);
  for (const auto& entry : fs::directory_iterator(folder_ / "a"))
    EXPECT_EQ(entry.path().string().find(".partial"), std::string::npos);
  EXPECT_EQ(make("b", {"--set", "change.poster_share=2"}), 1);
  EXPECT_THAT(err_.str(), HasSubstr("poster_share"));
  EXPECT_EQ(make("b", {"--set", "change.postershare=0.2"}), 1);
  EXPECT_THAT(err_.str(), HasSubstr("poster_share"));
  EXPECT_EQ(run({"make", "--preset", "castle", "--out", path("b")}), 1);
  EXPECT_EQ(run({"make", "--camera", "fisheye", "--out", path("b")}), 1);
  EXPECT_THAT(err_.str(), HasSubstr("omni, pinhole, stereo"));
  EXPECT_EQ(run({"make"}), 2);
  EXPECT_EQ(run({"paint"}), 2);
  EXPECT_EQ(make("b", {"--textures", path("nothing")}), 1);
  EXPECT_EQ(run({"render", "--preset", "tiny", "--pose", "1;2", "--out", path("x.png")}), 2);
  EXPECT_THAT(err_.str(), HasSubstr("x,y,heading"));
}

TEST_F(DataSet, PhotographsHangAsPosters) {
  fs::create_directories(folder_ / "photos");
  cv::imwrite(path("photos/a.png"), cv::Mat(40, 30, CV_8UC3, cv::Scalar(255, 0, 255)));
  std::ofstream(folder_ / "photos/notes.txt") << "not an image";
  const std::vector<std::string> view{"render",  "--preset", "tiny",      "--camera",
                                      "pinhole", "--pose",   "4,1.75,20", "--out"};
  auto plain = view, photos = view;
  plain.push_back(path("plain.png"));
  photos.insert(photos.end(), {path("photos.png"), "--textures", path("photos")});
  ASSERT_EQ(run(plain), 0) << err_.str();
  ASSERT_EQ(run(photos), 0) << err_.str();
  const auto magenta = [&](const std::string& name) {
    cv::Mat mask;
    cv::inRange(cv::imread(path(name)), cv::Scalar(40, 0, 40), cv::Scalar(255, 30, 255), mask);
    return cv::countNonZero(mask);
  };
  EXPECT_GT(magenta("photos.png"), magenta("plain.png") + 500);
}

TEST_F(DataSet, AnInterruptionLeavesWholeSessionsOnly) {
  const std::string command = "timeout --preserve-status -s INT 2 " ENGRAM_BIN_DIR
                              "/engram-world make --preset office --sessions 50 --out " +
                              path("a") + " 2> " + path("messages");
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 3) << read("messages");
  EXPECT_THAT(read("messages"), HasSubstr("stopped"));
  const auto info = nlohmann::json::parse(read("a/world.json"));
  EXPECT_FALSE(info["complete"]);
  std::size_t rawlogs = 0;
  for (const auto& entry : fs::directory_iterator(folder_ / "a")) {
    EXPECT_NE(entry.path().extension(), ".partial") << entry.path();
    rawlogs += entry.path().extension() == ".rawlog";
  }
  EXPECT_EQ(rawlogs, info["sessions"].size());
}

}  // namespace
}  // namespace engram::apps
