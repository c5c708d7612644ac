// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/error.h"
#include "engram/sources/image_folder_source.h"
#include "rawlog_fixture.h"

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include <fstream>
#include <functional>

namespace engram::sources::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

void writeText(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

std::string errorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const base::Error& e) {
    return e.what();
  }
  return "";
}

TEST(NaturalLess, NumbersByValue) {
  EXPECT_TRUE(naturalLess("IMG_9.jpg", "IMG_10.jpg"));
  EXPECT_FALSE(naturalLess("IMG_10.jpg", "IMG_9.jpg"));
  EXPECT_TRUE(naturalLess("a2b3", "a2b10"));
  EXPECT_TRUE(naturalLess("a", "b"));
  EXPECT_TRUE(naturalLess("1403715273262142976_0.jpg", "1403715273262142976_1.jpg"));
  EXPECT_NE(naturalLess("01.jpg", "1.jpg"), naturalLess("1.jpg", "01.jpg"));  // a strict order
  EXPECT_FALSE(naturalLess("x7", "x7"));
}

TEST(ImageFolder, NaturalOrderOneSecondApart) {
  const TempFolder folder;
  for (const int n : {10, 9, 1}) cv::imwrite(folder.path(cv::format("p%d.png", n)), picture(n));
  writeText(folder.path("notes.txt"), "not an image");
  auto source = openImageFolder(folder.path(""));
  const auto frames = readFrames(*source);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(source->problem(), "");
  EXPECT_EQ(source->progress(), 1.0);
  EXPECT_THAT((std::vector{frames[0].label, frames[1].label, frames[2].label}),
              ElementsAre("p1.png", "p9.png", "p10.png"));
  EXPECT_EQ(frames[2].stamp, 2.0);
  EXPECT_EQ(difference(frames[1].image, picture(9)), 0.0);
  EXPECT_FALSE(frames[0].T_odom_robot);
}

TEST(ImageFolder, CsvGivesOrderStampsAndOdometry) {
  const TempFolder folder;
  for (const int n : {1, 2, 3}) cv::imwrite(folder.path(cv::format("%d.png", n)), picture(n, {20, 10}, 1));
  writeText(folder.path("t.csv"),
            "# from the robot\nimage,stamp,x,y,yaw\n3.png,10.5,1,2,0.5\n1.png,11.5,,,\n2.png,12,nan,0,0\n");
  auto source = openImageFolder(folder.path(""), folder.path("t.csv"));
  const auto frames = readFrames(*source);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].label, "3.png");
  EXPECT_EQ(frames[0].stamp, 10.5);
  EXPECT_EQ(frames[0].image.channels(), 1);
  ASSERT_TRUE(frames[0].T_odom_robot);
  EXPECT_NEAR(frames[0].T_odom_robot->translation().y(), 2.0, 1e-12);
  EXPECT_FALSE(frames[1].T_odom_robot);
  EXPECT_FALSE(frames[2].T_odom_robot);
  EXPECT_THAT(source->problem(), HasSubstr("1 image(s) with odometry that is not a number"));
}

TEST(ImageFolder, BadImagesAndStampsAreLeftOutAndNamed) {
  const TempFolder folder;
  cv::imwrite(folder.path("1.jpg"), picture(1));
  cv::imwrite(folder.path("2.jpg"), picture(2));
  auto bytes = readAll(folder.path("2.jpg"));
  bytes.resize(bytes.size() / 2);
  writeAll(folder.path("2.jpg"), bytes);
  cv::imwrite(folder.path("3.jpg"), picture(3));
  writeText(folder.path("t.csv"), "image,stamp\n1.jpg,5\n2.jpg,6\n3.jpg,5\nmissing.jpg,8\n3.jpg,9\n");
  auto source = openImageFolder(folder.path(""), folder.path("t.csv"));
  testing::internal::CaptureStderr();
  EXPECT_EQ(readFrames(*source).size(), 2u);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_THAT(source->problem(), HasSubstr("2 image(s) left out: cannot be read (2.jpg: damaged JPEG"));
  EXPECT_THAT(source->problem(), HasSubstr("1 image(s) left out: the stamp repeats or goes back"));
}

TEST(ImageFolder, CsvOfAnyEditor) {
  const TempFolder folder;
  for (const int n : {1, 2}) cv::imwrite(folder.path(cv::format("%d.png", n)), picture(n, {20, 10}, 1));
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    writeText(folder.path("t.csv"), "\xEF\xBB\xBFimage,stamp" + end + "2.png,1.5" + end + "1.png,2.5");
    const auto frames = readFrames(*openImageFolder(folder.path(""), folder.path("t.csv")));
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_EQ(frames[1].label, "1.png");
    EXPECT_EQ(frames[1].stamp, 2.5);
  }
  EXPECT_THAT(errorOf([&] { openImageFolder(folder.path(""), folder.path("")); }), HasSubstr("is a folder"));
}

TEST(ImageFolder, StampsAreReadInTheirUnit) {
  const TempFolder folder;
  cv::imwrite(folder.path("1.png"), picture(1, {20, 10}, 1));
  const std::vector<std::pair<std::string, std::string>> files{
      {"1700000000.5", "1700000001.25"},
      {"1700000000500", "1700000001250"},
      {"1700000000500000", "1700000001250000"},
      {"1700000000500000000", "1700000001250000000"}};
  for (std::size_t i = 0; i < files.size(); ++i)
    for (const auto unit : {StampUnit::kAuto, stampUnitOf(stampUnitNames()[i])}) {
      writeText(folder.path("t.csv"),
                "image,stamp\n1.png," + files[i].first + "\n1.png," + files[i].second + "\n");
      auto source = openImageFolder(folder.path(""), folder.path("t.csv"), unit);
      EXPECT_EQ(toString(source->stampReading().unit), stampUnitNames()[i]);
      const auto frames = readFrames(*source);
      ASSERT_EQ(frames.size(), 2u) << source->problem();
      EXPECT_EQ(frames[0].stamp, 1700000000.5);
      EXPECT_EQ(frames[1].stamp, 1700000001.25);
    }
}

TEST(ImageFolder, AClockThatWasSetLosesNoImage) {
  const TempFolder folder;
  cv::imwrite(folder.path("1.png"), picture(1, {20, 10}, 1));
  std::string csv = "image,stamp\n";
  for (const double start : {12.0, 1.7e9, 1.6e9})  // power-on, time from the network, set back
    for (int i = 0; i < 15; ++i) csv += "1.png," + std::to_string(start + 0.1 * i) + "\n";
  writeText(folder.path("t.csv"), csv);
  auto source = openImageFolder(folder.path(""), folder.path("t.csv"), StampUnit::kSeconds);
  EXPECT_EQ(readFrames(*source).size(), 45u);
  EXPECT_EQ(source->problem(), "");
  EXPECT_THAT(source->clockNote(),
              HasSubstr("set back (1x); the clock leapt ahead by more than a year (1x)"));
}

TEST(ImageFolder, StampsThatARawlogCannotHoldAreLeftOut) {
  const TempFolder folder;
  cv::imwrite(folder.path("1.png"), picture(1, {20, 10}, 1));
  writeText(folder.path("t.csv"), "image,stamp\n1.png,1\n1.png,1e17\n1.png,2\n1.png,2.00000001\n1.png,3\n");
  auto source = openImageFolder(folder.path(""), folder.path("t.csv"), StampUnit::kSeconds);
  EXPECT_EQ(readFrames(*source).size(), 3u);
  EXPECT_THAT(source->problem(), HasSubstr("1 image(s) left out: a rawlog cannot hold the stamp"));
  EXPECT_THAT(source->problem(), HasSubstr("1 image(s) left out: the stamp repeats")) << "within 100 ns";
}

TEST(ImageFolder, ErrorsNameFileAndLine) {
  const TempFolder folder;
  EXPECT_THAT(errorOf([&] { openImageFolder(folder.path("none")); }), HasSubstr("no such folder"));
  EXPECT_THAT(errorOf([&] { openImageFolder(folder.path("")); }), HasSubstr("holds no images"));
  const auto withCsv = [&](const std::string& text) {
    writeText(folder.path("t.csv"), text);
    return errorOf([&] { openImageFolder(folder.path(""), folder.path("t.csv")); });
  };
  EXPECT_THAT(withCsv("image,time\n"), HasSubstr("unknown column 'time'"));
  EXPECT_THAT(withCsv("image,stamp,right,stamp\na.png,1,c.png\n"), HasSubstr("'stamp' stands twice"));
  EXPECT_THAT(withCsv("stamp\n1\n"), HasSubstr("one is 'image'"));
  EXPECT_THAT(withCsv("image,x,y\na.png,1,2\n"), HasSubstr("belong together"));
  EXPECT_THAT(withCsv("image,stamp\na.png,12abc\n"),
              HasSubstr("t.csv:2: column 'stamp': '12abc' is not a number"));
  EXPECT_THAT(withCsv("image,stamp\na.png\n"), HasSubstr("t.csv:2: 1 columns instead of 2"));
  EXPECT_THAT(withCsv("image,stamp\n"), HasSubstr("lists no images"));
  EXPECT_THAT(withCsv("image,stamp\na.png,inf\n"), HasSubstr("not a finite number"));
  EXPECT_THAT(withCsv("image,stamp\na.png,0e2000\n"), HasSubstr("the stamp '0e2000' is no number of s"));
  EXPECT_THAT(errorOf([&] { openImageFolder(folder.path(""), folder.path("no.csv")); }),
              HasSubstr("cannot be opened"));
}

}  // namespace
}  // namespace engram::sources::test
