// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/image_pairs.h"

#include "engram/base/error.h"
#include "rawlog_fixture.h"

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include <filesystem>
#include <fstream>
#include <functional>

namespace engram::sources::test::image_pairs {
namespace {

using ::testing::HasSubstr;

std::string errorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const base::Error& e) {
    return e.what();
  }
  return "";
}

void write(const TempFolder& folder, const std::string& name, int number) {
  std::filesystem::create_directories(std::filesystem::path(folder.path(name)).parent_path());
  cv::imwrite(folder.path(name), picture(number, {32, 24}, 1));
}

TEST(ImagePairs, PatternsAndStampsInNames) {
  const TempFolder folder;
  for (const int i : {0, 1, 2}) {
    write(folder, cv::format("1403715274%d62142970_0.png", i), i);
    write(folder, cv::format("1403715274%d62142970_1.png", i), 10 + i);
  }
  std::filesystem::remove(folder.path("1403715274162142970_1.png"));
  auto source = openImagePairs(folder.path("*_0.png"), folder.path("*_1.png"), "names");
  const auto frames = readFrames(*source);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(difference(frames[1].image, picture(2, {32, 24}, 1)), 0);
  EXPECT_EQ(difference(frames[1].right, picture(12, {32, 24}, 1)), 0);
  EXPECT_NEAR(frames[0].stamp, 1403715274.062142970, 1e-6);
  EXPECT_THAT(source->problem(), HasSubstr("1 left image(s) left out"));
  EXPECT_THAT(source->problem(), HasSubstr("1403715274162142970_0.png"));
}

TEST(ImagePairs, TwoFoldersPairedByNumberWithAFileOfStamps) {
  const TempFolder folder;
  for (const int i : {8, 9, 10}) {
    write(folder, cv::format("left/frame%d.png", i), i);
    write(folder, cv::format("right/%06d.png", i), 100 + i);
  }
  std::ofstream(folder.path("times.txt")) << "# seconds\n0.5\n0.75\n\n1.25\n";
  auto source = openImagePairs(folder.path("left"), folder.path("right"), folder.path("times.txt"));
  const auto frames = readFrames(*source);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(source->problem(), "");
  EXPECT_EQ(difference(frames[2].right, picture(110, {32, 24}, 1)), 0);
  EXPECT_EQ(frames[2].stamp, 1.25);
}

TEST(ImagePairs, MistakesAreNamed) {
  const TempFolder folder;
  for (const int i : {1, 2}) {
    write(folder, cv::format("left/a%d.png", i), i);
    write(folder, cv::format("right/b%d.png", i + 5), i);
  }
  const auto open = [&](const std::string& left, const std::string& right, const std::string& stamps) {
    return errorOf([&] { openImagePairs(folder.path(left), folder.path(right), stamps); });
  };
  EXPECT_THAT(open("left", "right", ""), HasSubstr("no two images belong together"));
  EXPECT_THAT(open("left/*.jpg", "right", ""), HasSubstr("no image fits"));
  EXPECT_THAT(open("left", "right", "names"), HasSubstr("holds no Unix time"));
  std::ofstream(folder.path("short.txt")) << "1\n";
  EXPECT_THAT(open("left", "right", folder.path("short.txt")), HasSubstr("1 stamps for 2 images"));
  std::ofstream(folder.path("bad.txt")) << "1\n2 s\n";
  EXPECT_THAT(open("left", "right", folder.path("bad.txt")), HasSubstr("bad.txt:2: '2 s'"));
  write(folder, "left/c1.png", 1);
  EXPECT_THAT(open("left", "right", ""), HasSubstr("have the same number 1"));
}

TEST(StampInName, UnixTimeInAllItsUnits) {
  EXPECT_NEAR(stampInName("x/1403715274302142976_0.jpg"), 1403715274.302142976, 1e-6);
  EXPECT_NEAR(stampInName("cam0_1403715274302142.png"), 1403715274.302142, 1e-6);
  EXPECT_NEAR(stampInName("1403715274302.png"), 1403715274.302, 1e-6);
  EXPECT_NEAR(stampInName("left_1403715274.302142.png"), 1403715274.302142, 1e-6);
  EXPECT_EQ(stampInName("12_1403715274.png"), 1403715274);
  EXPECT_THROW(stampInName("000123.png"), base::Error);
}

}  // namespace
}  // namespace engram::sources::test::image_pairs
