// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench_compare.h"
#include "bench/bench_images.h"
#include "engram/base/error.h"
#include "engram/base/rng.h"
#include "engram/store/map_file.h"
#include "eval_program.h"
#include "program_run.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace engram::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::vector<cv::Mat> twoImages() {
  std::vector<cv::Mat> images;
  for (int k = 0; k < 2; ++k) {
    images.emplace_back(48, 64, CV_8U);
    cv::RNG(static_cast<std::uint64_t>(k) + 1).fill(images.back(), cv::RNG::UNIFORM, 0, 256);
  }
  return images;
}

double difference(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_L1) / (48 * 64); }

TEST(BenchImages, PlacesDifferAndComeAgain) {
  const std::vector<cv::Mat> sources = twoImages();
  const BenchImages images(sources, 7), same(twoImages(), 7), other(twoImages(), 8);
  for (std::size_t i = 0; i < 40; ++i) {
    EXPECT_EQ(images.place(i).size(), cv::Size(64, 48));
    EXPECT_EQ(difference(images.place(i), same.place(i)), 0) << i;
    EXPECT_GT(difference(images.place(i), other.place(i)), 10) << i;
    for (std::size_t j = 0; j < i; ++j) EXPECT_GT(difference(images.place(i), images.place(j)), 10) << i;
  }
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(difference(sources[k], twoImages()[k]), 0);
}

/// Figures of 40 images whose times vary by a tenth from image to image, and by a little from run to run.
nlohmann::json figuresWith(double machine, double kernel, std::uint64_t seed) {
  base::Rng images(1), run(seed);
  nlohmann::json json;
  auto& each = json["each_ms"]["1000"];
  for (int i = 0; i < 40; ++i) {
    const double size = images.uniform(0.9, 1.1);
    const auto ms = [&](double cost) { return machine * cost * std::exp(0.03 * run.normal()); };
    each["reference"].push_back(ms(1.0));
    each["step perceive"].push_back(ms(5.0 * size));
    each["step recognise"].push_back(ms(kernel * 8.0 * size));
    each["step decide"].push_back(ms(0.001));
  }
  return json;
}

TEST(BenchCompare, FindsASlowKernelAndNothingElse) {
  const nlohmann::json before = figuresWith(1, 1, 1);
  for (std::uint64_t seed = 2; seed < 102; ++seed) {
    const double machine = 0.7 + 0.006 * static_cast<double>(seed);
    for (const auto& change : compareSpeed(before, figuresWith(machine, 1, seed)))
      EXPECT_FALSE(change.slower() || change.faster()) << change.what << " by " << change.ratio;
    for (const auto& change : compareSpeed(before, figuresWith(machine, 1.2, seed))) {
      EXPECT_EQ(change.slower(), change.what == "step recognise") << change.ratio;
      EXPECT_FALSE(change.faster());
    }
    for (const auto& change : compareSpeed(before, figuresWith(machine, 1 / 1.2, seed)))
      EXPECT_EQ(change.faster(), change.what == "step recognise") << change.ratio;
  }
  EXPECT_EQ(describe(compareSpeed(before, before)), "nothing is slower or faster beyond noise\n");
  EXPECT_THAT(describe(compareSpeed(before, figuresWith(1, 1.2, 2))),
              HasSubstr("slower: step recognise at 1000"));
}

TEST(BenchCompare, RefusesOtherFigures) {
  const nlohmann::json before = figuresWith(1, 1, 1);
  nlohmann::json other = before;
  other["each_ms"]["1000"]["step perceive"].push_back(1.0);
  EXPECT_THROW(compareSpeed(before, other), base::Error);
  other = {{"each_ms", {{"7", before["each_ms"]["1000"]}}}};
  EXPECT_THROW(compareSpeed(before, other), base::Error);
  EXPECT_THROW(compareSpeed(nlohmann::json::object(), before), base::Error);
}

class BenchTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "engram_bench_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return folder_ + "/" + name; }

  RunResult bench(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"bench", "--quick",       "--places", "12,20",
                                       "--out", path("out"),     "--json",   path("bench.json"),
                                       "--set", "bench.drive=2", "--set",    "bench.singles=4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runAs<EvalProgram>(arguments);
  }
  nlohmann::json figures() const { return nlohmann::json::parse(std::ifstream(path("bench.json"))); }

  std::string folder_;
};

TEST_F(BenchTest, HasEveryFigureForEverySize) {
  const RunResult run = bench({});
  ASSERT_EQ(run.code, kOk) << run.err;
  const auto json = figures();
  EXPECT_EQ(json.at("places"), nlohmann::json({12, 20}));
  for (const char* key : {"localise_ms", "localise_p95_ms", "map_ms", "open_ms", "map_bytes"})
    for (const char* places : {"12", "20"}) EXPECT_GT(json.at(key).at(places).get<double>(), 0) << key;
  EXPECT_GE(json.at("localise_p95_ms").at("12"), json.at("localise_ms").at("12"));
  EXPECT_TRUE(json.at("rss_bytes").contains("20"));
  EXPECT_EQ(json.at("recall_vs_exact").at("20"), 1.0);
  EXPECT_EQ(
      store::MapFile::open(path("out/bench_maps/20.engram"), store::Access::kReadOnly).load().places().size(),
      20u);
}

// The maps stay while what they are made of does.
TEST_F(BenchTest, KeepsItsMaps) {
  ASSERT_EQ(bench({}).code, kOk);
  const std::string map = path("out/bench_maps/20.engram");
  const auto made = fs::last_write_time(map);
  const std::vector<std::string> words{"--set", "recognise.scorer=tfidf_incremental", "--overwrite"};
  const RunResult other = bench({words[0], words[1]});
  EXPECT_EQ(other.code, kError);
  EXPECT_THAT(other.err, HasSubstr("other settings"));
  ASSERT_EQ(bench(words).code, kOk);
  EXPECT_EQ(fs::last_write_time(map), made);
  ASSERT_EQ(bench({"--overwrite", "--set", "extractor.max_features=300"}).code, kOk);
  EXPECT_NE(fs::last_write_time(map), made);
}

TEST_F(BenchTest, RefusesWhatItCannotUse) {
  EXPECT_EQ(bench({"--places", "1"}).code, kUsage);
  EXPECT_THAT(bench({"--compare", path("nowhere.json")}).err, HasSubstr("nowhere.json"));
  std::ofstream(path("other.json")) << "[1]";
  EXPECT_THAT(bench({"--compare", path("other.json")}).err, HasSubstr("it is no JSON of"));
  const RunResult nowhere = bench({"--images", path("nowhere")});
  EXPECT_EQ(nowhere.code, kError);
  EXPECT_THAT(nowhere.err, HasSubstr("nowhere"));
}

}  // namespace
}  // namespace engram::apps
