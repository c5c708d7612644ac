// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/truth.h"

#include "engram/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace engram::evaluation {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

FrameRef frame(std::uint64_t index, const std::string& label = "", double stamp = 0) {
  return {index, label, stamp, std::nullopt};
}

TruthOptions margin(int n) {
  TruthOptions options;
  options.margin = n;
  return options;
}

TEST(TruthRanges, AreInclusiveFromZeroAndWidenedByTheMargin) {
  for (const char* header : {"query_index,first_ref_index,last_ref_index", "query,first,last"}) {
    const std::string text = std::string("# a comment\r\n") + header + "\r\n0,0,2\r\n7, 5, 9\r\n";
    const auto truth = Truth::parse(text, "t.csv");
    EXPECT_EQ(truth.kind(), TruthKind::kRanges);
    for (std::uint64_t i = 0; i < 14; ++i) {
      EXPECT_EQ(truth.judge(frame(7), frame(i)), i >= 5 && i <= 9 ? Verdict::kRight : Verdict::kWrong) << i;
      const auto wide = Truth::parse(text, "t.csv", margin(3));
      EXPECT_EQ(wide.judge(frame(7), frame(i)), i >= 2 && i <= 12 ? Verdict::kRight : Verdict::kWrong) << i;
    }
    EXPECT_EQ(truth.judge(frame(1), frame(1)), Verdict::kUnknown);
    EXPECT_FALSE(truth.answerable(frame(1)));
    EXPECT_TRUE(truth.answerable(frame(0)));
  }
}

TEST(TruthMatches, UseTheNumberInTheFileName) {
  const auto truth = Truth::parse("image,matches\n41,1 2 3\n60,\n", "t.csv");
  EXPECT_EQ(truth.kind(), TruthKind::kMatches);
  EXPECT_EQ(truth.judge(frame(0, "images/41.jpg"), frame(0, "2.jpg")), Verdict::kRight);
  EXPECT_EQ(truth.judge(frame(0, "41.jpg"), frame(0, "4.jpg")), Verdict::kWrong);
  EXPECT_EQ(truth.judge(frame(0, "2.jpg"), frame(0, "41.jpg")), Verdict::kRight) << "symmetric";
  EXPECT_EQ(truth.judge(frame(0, "20.jpg"), frame(0, "3.jpg")), Verdict::kWrong) << "shows nothing known";
  EXPECT_EQ(truth.judge(frame(0, "20.jpg"), frame(0, "20.jpg")), Verdict::kRight);
  EXPECT_TRUE(truth.answerable(frame(0, "41.jpg")));
  EXPECT_FALSE(truth.answerable(frame(0, "20.jpg")));
  EXPECT_FALSE(truth.answerable(frame(0, "60.jpg")));
}

TEST(TruthMatches, CountFromOneWithoutFileNames) {
  const auto truth = Truth::parse("image,matches\n41,1 2 3\n", "t.csv");
  EXPECT_EQ(truth.judge(frame(40, "CAMERA1"), frame(2, "CAMERA1")), Verdict::kRight);
  EXPECT_EQ(truth.judge(frame(40, "CAMERA1"), frame(3, "CAMERA1")), Verdict::kWrong);
  EXPECT_EQ(truth.judge(frame(7, "41"), frame(8, "2")), Verdict::kRight) << "a bare number is a file name";
}

TEST(TruthMatches, AreWidenedByTheMargin) {
  const auto truth = Truth::parse("image,matches\n41,10 20\n", "t.csv", margin(2));
  for (int i = 1; i < 30; ++i) {
    const bool near = std::abs(i - 10) <= 2 || std::abs(i - 20) <= 2;
    EXPECT_EQ(truth.judge(frame(0, "41.jpg"), frame(0, std::to_string(i) + ".png")),
              near ? Verdict::kRight : Verdict::kWrong)
        << i;
  }
}

TEST(TruthLinks, AreUndirectedAndWidenedByHops) {
  const std::string text = "a,b,source\n92,93,tour\n93,94,tour\n94,95,tour\n92,113,seen\n";
  const auto truth = Truth::parse(text, "links.csv");
  EXPECT_EQ(truth.kind(), TruthKind::kLinks);
  const auto judge = [](const Truth& t, int a, int b) {
    return t.judge(frame(0, "IMG_0" + std::to_string(a) + ".jpg"),
                   frame(9, "IMG_" + std::to_string(b) + ".jpg"));
  };
  EXPECT_EQ(judge(truth, 93, 92), Verdict::kRight);
  EXPECT_EQ(judge(truth, 92, 93), Verdict::kRight);
  EXPECT_EQ(judge(truth, 93, 93), Verdict::kRight);
  EXPECT_EQ(judge(truth, 92, 94), Verdict::kWrong);
  EXPECT_EQ(judge(truth, 113, 93), Verdict::kWrong);
  EXPECT_EQ(judge(truth, 50, 93), Verdict::kUnknown);
  EXPECT_FALSE(truth.answerable(frame(0, "IMG_050.jpg")));
  const auto wide = Truth::parse(text, "links.csv", margin(1));
  EXPECT_EQ(judge(wide, 113, 93), Verdict::kRight);
  EXPECT_EQ(judge(wide, 113, 94), Verdict::kWrong);
  EXPECT_EQ(Truth::parse("a,b\n1,2\n", "l").judge(frame(0, "x"), frame(0, "1.jpg")), Verdict::kUnknown);
}

TEST(TruthPoses, CompareTheInterpolatedPositionWithTheSurveyedOne) {
  TruthOptions options;
  options.radius = 0.5;
  const auto truth =
      Truth::parse("# stamp x y z qx qy qz qw\n10.0 0 0 0 0 0 0 1\n11.0 2 0 0 0 0 0 1\n", "gt", options);
  EXPECT_EQ(truth.kind(), TruthKind::kPoses);
  auto place = frame(0);
  EXPECT_EQ(truth.judge(frame(0, "", 10.5), place), Verdict::kUnknown) << "the place was not surveyed";
  place.position = Eigen::Vector3d(1.0, 0.45, 0);
  EXPECT_EQ(truth.judge(frame(0, "", 10.5), place), Verdict::kRight);
  EXPECT_EQ(truth.judge(frame(0, "", 10.9), place), Verdict::kWrong);
  EXPECT_EQ(truth.judge(frame(0, "", 12.0), place), Verdict::kUnknown);
  EXPECT_TRUE(truth.answerable(frame(0, "", 10.5)));
  EXPECT_FALSE(truth.answerable(frame(0, "", 9.0)));
  EXPECT_NEAR(truth.position(10.25)->x(), 0.5, 1e-12);
}

TEST(TruthFiles, OfAnyEditorAreRead) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const auto truth = Truth::parse(
        "\xEF\xBB\xBF"
        "query,first,last" +
            end + "7,5,9",
        "t.csv");
    EXPECT_EQ(truth.judge(frame(7), frame(9)), Verdict::kRight);
    EXPECT_EQ(truth.judge(frame(7), frame(10)), Verdict::kWrong);
  }
}

TEST(TruthErrors, NameFileLineAndReason) {
  const auto refuses = [](const std::string& text, const std::string& message) {
    EXPECT_THAT([&] { Truth::parse(text, "t.csv"); }, ThrowsMessage<base::Error>(HasSubstr(message))) << text;
  };
  refuses("", "t.csv: is empty");
  refuses("# only\n\n", "t.csv: is empty");
  refuses("query,first,last\n", "t.csv: holds a header only");
  refuses("0,1,2\n",
          "t.csv:1: '0,1,2' is no known form of truth; known are the headers query,first,last and");
  refuses("query,first\n0,1\n", "t.csv:1: 'query,first' is no known form");
  refuses("query,first,last\n0,1\n", "t.csv:2: expected query,first,last, found '0,1'");
  refuses("query,first,last\n0,1,2,3\n", "t.csv:2: expected query,first,last");
  refuses("query,first,last\n\n# c\n0,1,x\n", "t.csv:4: last 'x' is not a whole number");
  refuses("query,first,last\n0,1.5,2\n", "t.csv:2: first '1.5' is not a whole number");
  refuses("query,first,last\n0,1,99999999999999999999\n", "is not a whole number");
  refuses("query,first,last\n0,5,3\n", "t.csv:2: the last reference lies before the first");
  refuses("query,first,last\n-1,5,6\n", "t.csv:2: indices count from 0");
  refuses("query,first,last\n3,5,6\n3,7,8\n", "t.csv:3: query 3 has a line already");
  refuses("image,matches\n41\n", "t.csv:2: expected image,matches, found '41'");
  refuses("image,matches\n41,1 b\n", "t.csv:2: match 'b' is not a whole number");
  refuses("a,b,source\n92\n", "t.csv:2: expected a,b or a,b,source, found '92'");
  refuses("a,b\n92,\n", "t.csv:2: b '' is not a whole number");
  refuses("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0\n", "t.csv:2: expected 8 numbers");
  EXPECT_THAT(
      [] { Truth::load("/nowhere/truth.csv"); },
      ThrowsMessage<base::Error>(AllOf(HasSubstr("/nowhere/truth.csv"), HasSubstr("cannot be opened"))));
  EXPECT_THAT([] { Truth::parse("query,first,last\n0,1,2\n", "t", margin(-1)); },
              ThrowsMessage<base::Error>(HasSubstr("--truth-margin")));
}

TEST(NumberInFileName, IsTheLastRunOfDigits) {
  EXPECT_EQ(numberInFileName("pano/IMG_092.jpg"), 92);
  EXPECT_EQ(numberInFileName("84.jpg"), 84);
  EXPECT_EQ(numberInFileName("cam2/frame_0012_left.png"), 12);
  EXPECT_EQ(numberInFileName("seq7/none.png"), std::nullopt);
  EXPECT_EQ(numberInFileName(""), std::nullopt);
}

/// The public data sets, where this machine has them.
std::filesystem::path datasets() {
  if (const char* folder = std::getenv("ENGRAM_DATASETS")) return folder;
  return std::filesystem::path(ENGRAM_SOURCE_DIR) / ".." / "shared" / "datasets";
}

TEST(TruthFiles, OfTheDataSetsAreRead) {
  const auto folder = datasets();
  if (!std::filesystem::exists(folder / "gardens_point")) {
    const char* ci = std::getenv("CI");
    if (ci && std::string(ci) == "true") FAIL() << "no data sets at " << folder << "; set ENGRAM_DATASETS";
    GTEST_SKIP() << "NO DATA SETS at " << folder
                 << ": the truth files of real data were NOT read; set ENGRAM_DATASETS";
  }
  const auto gardens = Truth::load(folder / "gardens_point" / "truth_day_left_day_right.csv");
  EXPECT_EQ(gardens.judge(frame(100), frame(102)), Verdict::kRight);
  EXPECT_EQ(gardens.judge(frame(100), frame(103)), Verdict::kWrong);
  EXPECT_EQ(Truth::load(folder / "corridor_milford" / "truth.csv").kind(), TruthKind::kRanges);
  const auto loop = Truth::load(folder / "rtabmap_samples" / "truth.csv");
  int answerable = 0;
  for (int i = 41; i <= 84; ++i) answerable += loop.answerable(frame(0, std::to_string(i) + ".jpg"));
  EXPECT_EQ(answerable, 44);
  const auto walk = Truth::load(folder / "pano_walk" / "links.csv");
  EXPECT_EQ(walk.judge(frame(0, "IMG_092.jpg"), frame(0, "IMG_113.jpg")), Verdict::kRight);
  const auto euroc = Truth::load(folder / "euroc_v1_stereo" / "groundtruth_tum.txt");
  EXPECT_FALSE(euroc.answerable(frame(0, "", 1403715273.262142976)));
  EXPECT_TRUE(euroc.answerable(frame(0, "", 1403715280.562142976)));
}

}  // namespace
}  // namespace engram::evaluation
