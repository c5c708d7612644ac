// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/program.h"
#include "engram/sources/rawlog_writer.h"
#include "engram/store/map_file.h"
#include "rawlog_fixture.h"
#include "run_fixture.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <sstream>

namespace engram::apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
namespace fs = std::filesystem;
namespace raw = engram::sources::test;

class LocalizeTest : public RunTest {
 protected:
  RunResult run(std::vector<std::string> more, const std::string& log) const {
    std::vector<std::string> arguments{config(), "--map", firstMap(), "--rawlog", log};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return localize(arguments);
  }
};

TEST_F(LocalizeTest, AnswersAreRightByTruthAndTheMapStaysByteForByte) {
  const std::string before = bytesOf(firstMap());
  const RunResult result =
      run({"--truth", truth(2), "--out", path("l.csv"), "--json", path("l.json"), "--report", path("r")},
          rawlog(2));
  ASSERT_EQ(result.code, kOk) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("38 images"), HasSubstr("of 38 with truth"), HasSubstr("ms per image")));
  EXPECT_TRUE(bytesOf(firstMap()) == before);
  EXPECT_FALSE(fs::exists(firstMap() + "-wal"));

  const auto j = jsonOf(path("l.json"));
  for (const char* key : {"images", "queries", "answerable", "accepted", "right", "wrong", "best_guess_right",
                          "within_1_25_places", "error_places", "adapted", "ms_per_image", "peak_rss_bytes"})
    EXPECT_TRUE(j.contains(key)) << key;
  EXPECT_EQ(j["images"], 38);
  EXPECT_EQ(j["adapted"], 0);
  EXPECT_GE(j["accepted"], 38 * 7 / 10);
  EXPECT_GE(j["right"].get<int>() * 100, j["accepted"].get<int>() * 95);
  EXPECT_LT(j["pose_error"]["median"], 0.08);
  EXPECT_LT(j["heading_error"]["median"], 0.026);
  EXPECT_LT(j["pose_nees"], 3);

  std::istringstream csv(bytesOf(path("l.csv")));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line,
            "index,stamp,label,outcome,place,place_label,best_guess,best_guess_label,posterior,similarity,"
            "inliers,verdict,best_guess_verdict,error_places,ms,reason,x,y,heading,sigma_along,sigma_across,"
            "sigma_heading,pose_error,heading_error,accepted_by");
  int lines = 0, right = 0;
  while (std::getline(csv, line)) {
    EXPECT_THAT(line, ::testing::StartsWith(std::to_string(lines) + ","));
    right += line.find(",right,") != std::string::npos && line.find(",recognised,") != std::string::npos;
    ++lines;
  }
  EXPECT_EQ(lines, 38);
  EXPECT_GE(right, j["right"].get<int>());
  EXPECT_THAT(bytesOf(path("r/images.jsonl")), HasSubstr("\"outcome\":\"recognised\""));
}

TEST_F(LocalizeTest, WithoutTruthVerdictsAreNull) {
  const RunResult result = run({"--json", path("l.json"), "-q"}, rawlog(2));
  ASSERT_EQ(result.code, kOk);
  EXPECT_THAT(result.out + result.err, IsEmpty());
  for (const char* key : {"answerable", "right", "wrong", "best_guess_right", "within_1_25_places",
                          "error_places", "pose_error", "heading_error", "pose_nees"})
    EXPECT_TRUE(jsonOf(path("l.json"))[key].is_null()) << key;
}

TEST_F(LocalizeTest, AdaptChangesMemoriesAndAddsNoPlace) {
  const std::string map = mapCopy();
  const auto content = [&] { return store::MapFile::open(map, store::Access::kReadOnly).load(); };
  const auto before = content();
  const RunResult result =
      localize({config(), "--map", map, "--rawlog", rawlog(2), "--adapt", "--json", path("l.json"), "-q"});
  ASSERT_EQ(result.code, kOk) << result.err;
  EXPECT_GE(jsonOf(path("l.json"))["adapted"], 20);
  const auto after = content();
  EXPECT_EQ(after.places().size(), before.places().size());
  EXPECT_EQ(after.edges().size(), before.edges().size());
  int learnt = 0;
  for (const auto& [id, place] : after.places())
    learnt += place.memory.updates > before.place(id).memory.updates;
  EXPECT_GE(learnt, static_cast<int>(before.places().size()) / 2);
  EXPECT_EQ(soundImages(map), 76u);
}

TEST_F(LocalizeTest, GlobalAnswersDoNotDependOnTheImagesBefore) {
  ASSERT_EQ(run({"--global", "--out", path("all.csv"), "-q"}, rawlog(1)).code, kOk);
  const auto frames = firstFrames(20);
  writeRawlog(path("tail.rawlog"), {frames.begin() + 15, frames.end()});
  ASSERT_EQ(run({"--global", "--out", path("tail.csv"), "-q"}, path("tail.rawlog")).code, kOk);
  const auto answers = [&](const std::string& file, int skip) {  // outcome … inliers
    std::istringstream csv(bytesOf(path(file)));
    std::string line, result;
    for (int i = 0; i <= skip; ++i) std::getline(csv, line);
    for (int i = 0; i < 5 && std::getline(csv, line); ++i) {
      std::size_t from = 0, to = 0;
      for (int comma = 0; comma < 3; ++comma) from = line.find(',', from) + 1;
      to = from;
      for (int comma = 0; comma < 8; ++comma) to = line.find(',', to) + 1;
      result += line.substr(from, to - from) + "\n";
    }
    return result;
  };
  EXPECT_EQ(answers("tail.csv", 0), answers("all.csv", 15));
}

TEST_F(LocalizeTest, TheTruthOfAnotherDriveIsRefused) {
  const RunResult result = run({"--truth", truth(1), "--json", path("l.json")}, rawlog(2));
  EXPECT_EQ(result.code, kError);
  EXPECT_THAT(result.err, HasSubstr("1.tum: is not the truth of these images"));
  EXPECT_FALSE(fs::exists(path("l.json"))) << "no figures by a wrong truth";
}

/// The first images of the first drive, as engram-rawlog pack keeps them.
std::string packed(const std::string& path, const std::vector<int>& numbers, bool names = true) {
  sources::RawlogWriterParams params;
  params.file_names = names;
  sources::RawlogWriter writer(path, params);
  auto frames = firstFrames(numbers.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].label = "IMG_" + std::to_string(numbers[i]) + ".jpg";
    writer.add(frames[i]);
  }
  writer.close();
  return path;
}

// The order of the images says that the first one shows the first place; its name, that it was taken
// elsewhere.
TEST_F(LocalizeTest, TruthGoesByTheNamesThatPackKept) {
  std::vector<int> numbers(16);
  std::iota(numbers.begin(), numbers.end(), 1);
  std::string matches = "image,matches\n";
  for (const int n : numbers) matches += std::to_string(n) + "," + std::to_string(n) + "\n";
  writeBytes(path("t.csv"), matches);
  const std::string map = path("m.engram");
  ASSERT_EQ(slam({config(), "--rawlog", packed(path("map.rawlog"), numbers), "--map", map, "-q"}).code, kOk);
  const auto score = [&](const std::string& log) {
    const RunResult result = localize({config(), "--map", map, "--rawlog", log, "--global", "--truth",
                                       path("t.csv"), "--truth-margin", "3", "--json", path("l.json"), "-q"});
    EXPECT_EQ(result.code, kOk) << result.err;
    return std::pair(jsonOf(path("l.json"))["best_guess_right"].get<int>(), result.err);
  };
  const auto [right, silence] = score(packed(path("a.rawlog"), numbers));
  EXPECT_EQ(right, 16);
  EXPECT_EQ(silence, "");
  numbers[0] = 900;
  const auto [fewer, stillSilence] = score(packed(path("b.rawlog"), numbers));
  EXPECT_EQ(fewer, 15);
  EXPECT_EQ(stillSilence, "");
  const auto [counted, notice] = score(packed(path("c.rawlog"), numbers, false));
  EXPECT_EQ(counted, 16);
  EXPECT_THAT(notice,
              HasSubstr("16 images have no names (their label is 'CAMERA'): they were counted from 1"));
}

TEST_F(LocalizeTest, UsageErrorsAndHelp) {
  EXPECT_EQ(localize({}).code, kUsage);
  EXPECT_EQ(localize({config(), "--bogus"}).code, kUsage);
  EXPECT_EQ(localize({config(), "--truth-margin", "x"}).code, kUsage);
  const RunResult help = localize({"--help"});
  EXPECT_EQ(help.code, kOk);
  EXPECT_THAT(help.out, AllOf(HasSubstr("Examples"), HasSubstr("Exit codes"), HasSubstr("--adapt")));
  const RunResult missing = localize({config(), "--rawlog", rawlog(2)});
  EXPECT_EQ(missing.code, kUsage);
  EXPECT_THAT(missing.err, HasSubstr("--map is needed, and --rawlog, --images, --video or --live"));
}

TEST_F(LocalizeTest, BadInputIsNamed) {
  const auto expectError = [](const RunResult& result, const std::string& part) {
    EXPECT_EQ(result.code, kError);
    EXPECT_THAT(result.err, HasSubstr(part));
  };
  expectError(localize({config(), "--map", path("none.engram"), "--rawlog", rawlog(2)}), "none.engram");
  writeBytes(path("no.engram"), "this is no map");
  expectError(localize({config(), "--map", path("no.engram"), "--rawlog", rawlog(2)}), "no.engram");
  expectError(run({}, path("none.rawlog")), "none.rawlog: no such file");
  writeBytes(path("l.csv"), "precious");
  expectError(run({"--out", path("l.csv")}, rawlog(2)),
              "l.csv: exists already; choose another name or give --overwrite");
  EXPECT_EQ(bytesOf(path("l.csv")), "precious");
  fs::create_directory(path("r"));
  writeBytes(path("r/images.jsonl"), "precious");
  expectError(run({"--report", path("r")}, rawlog(2)),
              "images.jsonl: exists already; choose another name or give --overwrite");
  EXPECT_EQ(bytesOf(path("r/images.jsonl")), "precious");
  expectError(run({"--set", "place.spacing=far"}, rawlog(2)), "--set");
  expectError(run({"--truth", path("none.tum")}, rawlog(2)), "none.tum");
  writeBytes(path("bad.tum"), "1 2 3\n");
  expectError(run({"--truth", path("bad.tum")}, rawlog(2)), "bad.tum");
  writeRawlog(path("a.rawlog"), firstFrames(2));
  expectError(run({"--out", path("none/l.csv"), "-q"}, path("a.rawlog")), path("none/l.csv"));
  expectError(run({"--json", "/proc/l.json", "-q"}, path("a.rawlog")), "/proc/l.json");
  raw::writeWithMrpt(path("blind.rawlog"), {raw::laserObject(raw::kStart)}, true);
  expectError(run({"-q"}, path("blind.rawlog")), "no images");
  raw::writeWithMrpt(path("small.rawlog"), {raw::imageObject(raw::kStart, raw::picture(1, {320, 200}))},
                     true);
  expectError(run({"-q"}, path("small.rawlog")), "320x200");
}

TEST_F(LocalizeTest, MapOfAnotherCameraExtractorOrMemoryIsRefusedByName) {
  const std::string before = bytesOf(firstMap());
  for (const auto& [set, word] : {std::pair{"extractor.extractor=orb", "the extractor 'surf'"},
                                  {"extractor.extractor=sift", "the extractor 'surf'"},
                                  {"memory.memory=static", "the memory model 'fsh'"},
                                  {"camera.file=", "the camera"}}) {
    for (const char* adapt : {"-q", "--adapt"}) {
      const RunResult result = run({"--set", set, adapt}, rawlog(2));
      EXPECT_EQ(result.code, kError) << set;
      EXPECT_THAT(result.err, HasSubstr(word)) << set;
    }
  }
  EXPECT_TRUE(bytesOf(firstMap()) == before);
}

TEST_F(LocalizeTest, DamagedMapIsRefused) {
  const std::string map = mapCopy();
  std::string bytes = bytesOf(map);
  for (std::size_t i = bytes.size() / 3; i < bytes.size(); i += 997) bytes[i] ^= 0x20;
  writeBytes(map, bytes);
  const RunResult result = localize({config(), "--map", map, "--rawlog", rawlog(2), "-q"});
  EXPECT_EQ(result.code, kError);
  EXPECT_THAT(result.err, HasSubstr(map));
  EXPECT_TRUE(bytesOf(map) == bytes);
}

TEST_F(LocalizeTest, TruncatedRawlogIsAnsweredUpToTheDamage) {
  writeRawlog(path("a.rawlog"), firstFrames(10));
  fs::resize_file(path("a.rawlog"), fs::file_size(path("a.rawlog")) / 2);
  const RunResult result = run({"--out", path("l.csv"), "-q"}, path("a.rawlog"));
  EXPECT_EQ(result.code, kPartial);
  EXPECT_THAT(result.err, AllOf(HasSubstr("truncated"), HasSubstr("images read")));
  const std::string csv = bytesOf(path("l.csv"));
  EXPECT_GE(std::count(csv.begin(), csv.end(), '\n'), 4);
}

TEST_F(LocalizeTest, BlackAndOddImagesAreUnusableAndTheRestIsAnswered) {
  const auto frames = firstFrames(4);
  raw::writeWithMrpt(path("odd.rawlog"),
                     {raw::imageObject(raw::kStart, frames[0].image),
                      raw::imageObject(raw::kStart + 1, cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(0))),
                      raw::imageObject(raw::kStart + 2, cv::Mat(200, 320, CV_8UC3, cv::Scalar::all(90))),
                      raw::imageObject(raw::kStart + 3, frames[3].image)},
                     true);
  const RunResult result = run({"--out", path("l.csv"), "-q"}, path("odd.rawlog"));
  EXPECT_EQ(result.code, kOk) << result.err;
  EXPECT_THAT(bytesOf(path("l.csv")),
              AllOf(HasSubstr("too few features"), HasSubstr("the image is 320x200")));
}

}  // namespace
}  // namespace engram::apps
