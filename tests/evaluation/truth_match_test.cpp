// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/truth_match.h"

#include <gmock/gmock.h>

namespace engram::evaluation::truth_match {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

FrameRef frame(std::uint64_t index, const std::string& label, double stamp = 0) {
  return {index, label, stamp, std::nullopt};
}

std::string imageName(int n) { return "IMG_" + std::to_string(n) + ".jpg"; }

/// A run of images whose names are numbered from `first`, after one that made the places `from` to `to`.
TruthMatch runOf(const Truth& truth, int first, int n, int from = 0, int to = -1) {
  TruthMatch match;
  for (int i = 0; i < n; ++i)
    match.addImage(truth, frame(static_cast<std::uint64_t>(i), imageName(first + i), i));
  for (int i = from; i <= to; ++i) match.addPlace(truth, frame(0, imageName(i)));
  return match;
}

/// Images 101 to 140 match 1 to 40.
Truth matches() {
  std::string text = "image,matches\n";
  for (int i = 101; i <= 140; ++i) text += std::to_string(i) + "," + std::to_string(i - 100) + "\n";
  return Truth::parse(text, "t.csv");
}

TEST(TruthMatch, TheRightTruthIsTaken) {
  const Truth truth = matches();
  EXPECT_EQ(runOf(truth, 1, 140).problem(truth), "") << "one drive with its loops";
  EXPECT_EQ(runOf(truth, 101, 40, 1, 40).problem(truth), "") << "a second drive in the map of the first";
  EXPECT_EQ(runOf(truth, 101, 40).problem(truth), "") << "in a map of few places";
  EXPECT_EQ(runOf(truth, 101, 10).problem(truth), "") << "a piece of the drive: all its images are known";
  EXPECT_EQ(runOf(truth, 1, 1000).problem(truth), "") << "a long drive with few loops";
  EXPECT_EQ(TruthMatch().problem(truth), "") << "nothing was shown";
}

TEST(TruthMatch, TheTruthOfOtherImagesIsRefused) {
  const Truth truth = matches();
  EXPECT_THAT(
      runOf(truth, 1001, 40).problem(truth),
      HasSubstr("t.csv: is not the truth of these images: of its 80 images (numbers in file names) 0 occur "
                "here, and it tells of 0 of 40 images"));
  EXPECT_THAT(runOf(truth, 1001, 40, 1, 40).problem(truth),
              HasSubstr("40 occur here, and it tells of 0 of 40"))
      << "the map alone does not make it the truth of the run";
  EXPECT_THAT(runOf(truth, 131, 40).problem(truth), HasSubstr("10 occur here, and it tells of 10 of 40"));
}

TEST(TruthMatch, LinksWithoutNamesAreRefusedAndSaidWhy) {
  const Truth truth = Truth::parse("a,b\n1,2\n2,3\n3,4\n", "links.csv");
  TruthMatch match;
  for (std::uint64_t i = 0; i < 4; ++i) match.addImage(truth, frame(i, "CAMERA1"));
  EXPECT_THAT(
      match.problem(truth),
      AllOf(HasSubstr("links.csv: is not the truth of these images"),
            HasSubstr("4 images have none (their label is 'CAMERA1'): engram-rawlog pack keeps them")));
  EXPECT_EQ(truth.judge(frame(0, "CAMERA1"), frame(1, "CAMERA1")), Verdict::kUnknown)
      << "the number of a sensor is not that of an image";
}

TEST(TruthMatch, CountedImagesAreSaid) {
  const Truth truth = Truth::parse("image,matches\n3,1\n4,2\n", "t.csv");
  TruthMatch counted, named;
  for (int i = 0; i < 4; ++i) {
    counted.addImage(truth, frame(static_cast<std::uint64_t>(i), "CAMERA"));
    named.addImage(truth, frame(static_cast<std::uint64_t>(i), imageName(i + 1)));
  }
  EXPECT_EQ(counted.problem(truth), "");
  EXPECT_THAT(counted.notice(truth),
              AllOf(HasSubstr("t.csv: goes by the numbers in the names of image files"),
                    HasSubstr("'CAMERA'"), HasSubstr("counted from 1")));
  EXPECT_EQ(named.problem(truth) + named.notice(truth), "");
}

TEST(TruthMatch, RangesGoByTheIndex) {
  std::string text = "query,first,last\n";
  for (int i = 500; i < 600; ++i) text += std::to_string(i) + ",0,9\n";
  const Truth truth = Truth::parse(text, "r.csv");
  EXPECT_THAT(runOf(truth, 500, 100).problem(truth),
              AllOf(HasSubstr("of its 100 queries (numbers of images in their order, from 0) 0 occur")))
      << "the names say 500, the order says 0";
  EXPECT_EQ(runOf(truth, 0, 600).problem(truth), "");
}

TEST(TruthMatch, PosesGoByTheirStamps) {
  std::string text;
  for (int i = 0; i <= 100; ++i) text += std::to_string(1000 + i) + " 0 0 0 0 0 0 1\n";
  const Truth truth = Truth::parse(text, "gt.tum");
  const auto problem = [&](double from, double to) {
    TruthMatch match;
    for (double stamp = from; stamp <= to; stamp += 0.5) match.addImage(truth, frame(0, "CAMERA", stamp));
    return match.problem(truth);
  };
  EXPECT_EQ(problem(1000, 1100), "");
  EXPECT_EQ(problem(1010, 1020), "") << "a piece of the drive";
  EXPECT_EQ(problem(900, 1100), "") << "the tracking began late";
  EXPECT_THAT(problem(2000, 2100),
              HasSubstr("gt.tum: is not the truth of these images: of its 101 poses (by their "
                        "stamps) 0 occur here, and it tells of 0 of 201 images"));
  EXPECT_THAT(problem(2000, 2100),
              HasSubstr("its stamps are 1000.000 to 1100.000, those of the images 2000.000 to"));
  EXPECT_THAT(problem(1090, 1200), HasSubstr("is not the truth"));
  EXPECT_THAT(problem(1, 1.1), HasSubstr("they seem to be milliseconds"));
}

}  // namespace
}  // namespace engram::evaluation::truth_match
