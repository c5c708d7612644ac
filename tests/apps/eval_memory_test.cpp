// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/methods.h"
#include "common/recorded_drive.h"
#include "engram/base/error.h"
#include "engram/base/rng.h"
#include "eval_program.h"
#include "make_features.h"
#include "memory/lab_figures.h"
#include "memory/method_run_file.h"
#include "memory/paper_findings.h"
#include "program_run.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <unistd.h>

namespace engram::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Station, NearestImageAlsoAcrossTheSeamOfTheTour) {
  const auto choose = nearestToStations(4, 8.0).choose;  // stations at 0, 2, 4, 6
  EXPECT_THAT(choose({0.6, 1.9, 4.4, 5.9, 7.8}), ElementsAre(4u, 1u, 2u, 3u));
  EXPECT_TRUE(choose({}).empty());
}

TEST(RingDistance, GoesTheShorterWay) {
  EXPECT_DOUBLE_EQ(ringDistance(1, 79.5, 80), 1.5);
  EXPECT_DOUBLE_EQ(ringDistance(79.5, 1, 80), 1.5);
  EXPECT_DOUBLE_EQ(ringDistance(10, 50, 80), 40);
}

// F-E15: sigma of intensities in [0, 1], clipped. Half of the noise on black is lost.
TEST(ImageNoise, HasItsSigmaAndIsClipped) {
  cv::Mat grey(200, 200, CV_8UC1, cv::Scalar(128)), black(200, 200, CV_8UC1, cv::Scalar(0));
  const cv::Mat before = grey;
  addNoise(grey, 0.15, 1);
  cv::Scalar mean, sigma;
  cv::meanStdDev(grey, mean, sigma);
  EXPECT_NEAR(mean[0], 128, 1);
  EXPECT_NEAR(sigma[0], 0.15 * 255, 0.6);
  EXPECT_EQ(cv::countNonZero(before != 128), 0) << "the image that was given is not changed";
  addNoise(black, 0.15, 2);
  EXPECT_NEAR(cv::mean(black)[0], 0.15 * 255 / std::sqrt(2 * M_PI), 0.6);  // E[max(0, x)]
}

TEST(Occlusion, RemovesItsShareUniformlyAndKeepsTheOrder) {
  std::vector<int> identities(200);
  std::iota(identities.begin(), identities.end(), 0);
  auto features = memory::makeFeatures(identities, std::vector<float>(200, 1.0f));
  for (std::size_t i = 0; i < 200; ++i) features.keypoints[i].x = static_cast<float>(i);
  std::vector<int> kept(200, 0);
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const auto rest = without(features, 0.25, seed);
    ASSERT_EQ(rest.size(), 150u);
    for (std::size_t k = 0; k < rest.size(); ++k) {
      ++kept[static_cast<std::size_t>(rest.keypoints[k].x)];
      if (k > 0) {
        ASSERT_LT(rest.keypoints[k - 1].x, rest.keypoints[k].x);
      }
    }
  }
  // Binomial with n = 400, p = 0.75: sigma 8.7; five of them for the worst of 200.
  for (const int n : kept) EXPECT_NEAR(n, 300, 44);
  EXPECT_EQ(without(features, 0.0, 1).size(), 200u);
}

/// Four sequences of three images in two blocks; errors are given image by image.
struct Sample4x3 {
  std::vector<Sequence> sequences{{0, 0, 0}, {0, 5, 0}, {1, 0, 1}, {1, 3, 1}};
  MethodRun run(const std::string& name, std::vector<float> errors) const {
    return {name, {UpdateState{}}, {{"clean", 1, errors, errors}}};
  }
};

TEST(LabFigures, CountGlobalAndLocalApart) {
  const Sample4x3 sample;
  //                                        global first: 0, 2, 1.25, 1.26
  const MethodRun run = sample.run("m", {0, 1, 2, 2, 0, 0, 1.25f, 5, 5, 1.26f, 0, 0});
  const auto figures = figuresOf({run}, sample.sequences, 3);
  ASSERT_EQ(figures.size(), 1u);
  EXPECT_DOUBLE_EQ(figures[0].globalSuccess.value, 0.5);
  EXPECT_DOUBLE_EQ(figures[0].localSuccess.value, 5.0 / 8);
  EXPECT_NEAR(figures[0].globalError.value, (0 + 2 + 1.25 + 1.26) / 4, 1e-6);
  EXPECT_NEAR(figures[0].localError.value, (1 + 2 + 0 + 0 + 5 + 5 + 0 + 0) / 8.0, 1e-6);
  EXPECT_EQ(figures[0].globalSuccess.blocks, 2);
}

TEST(LabFigures, AdvantageIsTheDifferenceOnTheSameImages) {
  const Sample4x3 sample;
  const MethodRun good = sample.run("good", std::vector<float>(12, 0.0f));
  const MethodRun bad = sample.run("bad", {0, 9, 9, 0, 0, 0, 9, 9, 9, 0, 0, 0});
  const auto advantages = advantagesOfFirst({good, bad}, sample.sequences, 3);
  ASSERT_EQ(advantages.size(), 1u);
  EXPECT_EQ(advantages[0].over, "bad");
  EXPECT_DOUBLE_EQ(advantages[0].share.value, 5.0 / 12);
}

/// F-28: errors that fall, stay or rise are told apart, and an update too early or too late.
TEST(PaperFindings, AreFoundWhereTheCurvesHaveThemAndNowhereElse) {
  const auto curve = [](const std::string& method, const std::string& condition,
                        const std::vector<double>& errors) {
    std::vector<LabFigure> figures;
    for (const double error : errors) {
      LabFigure f;
      f.method = method;
      f.condition = condition;
      f.update = static_cast<int>(figures.size()) + 1;
      f.error.value = error;
      f.globalSuccess.value = 0.8;
      f.localSuccess.value = 0.9;
      f.bytesPerPlace = method == "bow_80" ? 840 : 100;
      figures.push_back(f);
    }
    return figures;
  };
  const auto asked = [](const std::vector<std::vector<LabFigure>>& curves) {
    std::vector<LabFigure> all;
    for (const auto& c : curves) all.insert(all.end(), c.begin(), c.end());
    std::map<std::string, bool> found;
    for (const auto& f : paperFindings(all)) found[f.claim] = f.found;
    return found;
  };
  const auto paper = asked({curve("fsh", "clean", {2, 1.8, 1.5, 1.2, 1, 1, 1, 0.9}),
                            curve("fsh", "noise", {3, 3.1, 2.5, 2, 2, 2, 2, 1.9}),
                            curve("multi_store_4_5", "clean", {2, 2.1, 2.2, 2.3, 1.8, 1.7, 1.6, 1.5}),
                            curve("bow_80", "clean", {2, 2, 2, 2.4, 2.6, 2.3, 2, 2})});
  EXPECT_EQ(paper.size(), 9u);
  for (const auto& [claim, found] : paper) EXPECT_TRUE(found) << claim;
  const auto other = asked({curve("fsh", "clean", {1, 1.8, 1.5, 1.2, 1, 1, 1, 3}),
                            curve("fsh", "noise", {3, 3.1, 2.5, 2, 2, 2, 2, 4}),
                            curve("multi_store_4_5", "clean", {2, 1.9, 1.8, 1.7, 1.6, 1.7, 1.6, 1.5}),
                            curve("bow_80", "clean", {2, 2, 2, 1.9, 1.8, 1.7, 1.6, 1.5})});
  EXPECT_EQ(other.size(), 9u);
  int found = 0;
  for (const auto& [claim, is] : other) found += is;
  EXPECT_EQ(found, 2) << "that local answers recover, and the bytes";
  EXPECT_TRUE(asked({curve("replace", "clean", {1, 2})}).empty());
}

TEST(Methods, AreTheOnesThatThePapersCompare) {
  std::set<std::string> names;
  for (const auto& method : comparedMethods({}, 1000)) names.insert(method.name);
  EXPECT_EQ(names, (std::set<std::string>{"fsh", "fsh_learned", "fsh_ungated", "fsh_votes", "multi_store_4_5",
                                          "multi_store_2_8", "bow_80", "bow_1000", "static", "replace"}));
  EXPECT_EQ(sweptMethods({}).size(), 7u + 9u);  // F-23
}

class MemoryLabTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    char name[] = "/tmp/engram_eval_XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    folder_ = name;
    first_ = new RunResult(memory({"--out", path("one"), "--json", path("one.json"), "--threads", "1"}));
  }
  static void TearDownTestSuite() {
    fs::remove_all(folder_);
    delete first_;
  }
  static std::string path(const std::string& name) { return folder_ + "/" + name; }
  static std::string read(const std::string& name) {
    std::ifstream in(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static RunResult memory(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(),
                     {"memory", "--quick", "--methods", "fsh,bow_80,static", "--set", "memory_lab.places=8",
                      "--set", "memory_lab.updates=2", "--set", "memory_lab.test_spacing=2"});
    return runAs<EvalProgram>(arguments);
  }

  static std::string folder_;
  static const RunResult* first_;
};
std::string MemoryLabTest::folder_;
const RunResult* MemoryLabTest::first_ = nullptr;

TEST_F(MemoryLabTest, WritesEveryFigure) {
  ASSERT_EQ(first_->code, kOk) << first_->err;
  const auto json = nlohmann::json::parse(read("one.json"));
  const auto& results = json.at("results");
  EXPECT_EQ(results.size(), 3u * 4u * 2u);  // methods, conditions, updates
  for (const auto& r : results) {
    for (const char* key : {"global_success", "local_success"}) {
      EXPECT_GE(r.at(key).get<double>(), 0);
      EXPECT_LE(r.at(key).get<double>(), 1);
    }
    EXPECT_GE(r.at("mean_error").get<double>(), 0);
    EXPECT_LE(r.at("mean_error").get<double>(), 4);  // half of the ring
    EXPECT_GT(r.at("bytes_per_place").get<double>(), 10000);
  }
  const std::string page = read("one/report.html");
  EXPECT_THAT(page, HasSubstr("95 %"));
  EXPECT_THAT(page, HasSubstr("[memory_lab]"));
  EXPECT_EQ(page.find("http://www.w3.org/2000/svg") == std::string::npos, false);
  EXPECT_EQ(page.find("<script"), std::string::npos);
}

/// Every figure counted once more from the single answers, image by image.
TEST_F(MemoryLabTest, FiguresAreThoseOfTheSingleAnswers) {
  ASSERT_EQ(first_->code, kOk) << first_->err;
  constexpr std::size_t kLength = 5;  // images of a sequence with --quick
  const auto json = nlohmann::json::parse(read("one.json"));
  int compared = 0;
  for (const char* method : {"fsh", "bow_80", "static"})
    for (const Cell& cell : readMethodRun(path(std::string("one/runs/") + method + ".json")).cells) {
      ASSERT_EQ(cell.interpolated.size(), 20 * kLength);
      double first = 0, later = 0, sum = 0;
      for (std::size_t i = 0; i < cell.interpolated.size(); ++i) {
        (i % kLength == 0 ? first : later) += cell.interpolated[i] <= 1.25f;
        sum += cell.interpolated[i];
      }
      for (const auto& r : json.at("results")) {
        if (r.at("method") != method || r.at("condition") != cell.condition || r.at("update") != cell.update)
          continue;
        EXPECT_NEAR(r.at("global_success").get<double>(), first / 20, 1e-9);
        EXPECT_NEAR(r.at("local_success").get<double>(), later / 80, 1e-9);
        EXPECT_NEAR(r.at("mean_error").get<double>(), sum / 100, 1e-6);
        ++compared;
      }
    }
  EXPECT_EQ(compared, 24);
}

TEST_F(MemoryLabTest, StaticPlacesNeverChangeAndLearningOnesDo) {
  const MethodRun fixed = readMethodRun(path("one/runs/static.json"));
  EXPECT_EQ(fixed.updates[0].holdings.bytesPerPlace, fixed.updates[1].holdings.bytesPerPlace);
  EXPECT_EQ(fixed.cells[0].interpolated, fixed.cells[4].interpolated);
  const MethodRun bag = readMethodRun(path("one/runs/bow_80.json"));
  EXPECT_GE(bag.updates[1].holdings.bytesPerPlace, bag.updates[0].holdings.bytesPerPlace);
  const MethodRun fsh = readMethodRun(path("one/runs/fsh.json"));
  EXPECT_GT(fsh.updates[1].learning.learnt, 0);
  EXPECT_NE(fsh.updates[0].holdings.bytesPerPlace, fsh.updates[1].holdings.bytesPerPlace);
}

TEST_F(MemoryLabTest, GoesOnWhereItStoppedWithEqualFigures) {
  fs::remove(path("one/runs/fsh.json"));  // as if it had been interrupted
  const std::string csv = read("one/results.csv");
  const RunResult again = memory({"--out", path("one"), "--json", path("again.json"), "--threads", "2"});
  ASSERT_EQ(again.code, kOk) << again.err;
  EXPECT_EQ(read("one/results.csv"), csv);
  EXPECT_EQ(read("again.json"), read("one.json"));
}

TEST_F(MemoryLabTest, RecordsDrivesAnewWhenTheWorldIsAnother) {
  fs::copy(path("one"), path("other"), fs::copy_options::recursive);
  const RunResult refused = memory({"--out", path("other"), "--seed", "4"});
  EXPECT_EQ(refused.code, kError);
  EXPECT_THAT(refused.err, HasSubstr("--overwrite"));
  EXPECT_EQ(read("other/results.csv"), read("one/results.csv"));
  const std::string drive = read("other/drives/tour_1.json");
  ASSERT_EQ(memory({"--out", path("other"), "--seed", "4", "--overwrite"}).code, kOk);
  EXPECT_NE(read("other/drives/tour_1.json"), drive);
}

TEST_F(MemoryLabTest, DamagedIntermediateFilesAreNamed) {
  fs::copy(path("one"), path("damaged"), fs::copy_options::recursive);
  std::ofstream(path("damaged/runs/static.json")) << "{\"method\":";
  const RunResult result = memory({"--out", path("damaged")});
  EXPECT_EQ(result.code, kError);
  EXPECT_THAT(result.err, HasSubstr("static.json"));
}

TEST_F(MemoryLabTest, SaysWhatIsWrongWithTheCommand) {
  EXPECT_EQ(memory({}).code, kUsage);  // no --out
  EvalProgram program;
  std::ostringstream out, err;
  EXPECT_EQ(runProgram(program, {"memory", "--out", path("x"), "--methods", "fish"}, out, err), kUsage);
  EXPECT_THAT(err.str(), HasSubstr("fish"));
  EXPECT_THAT(err.str(), HasSubstr("multi_store_4_5"));
  EvalProgram second;
  EXPECT_EQ(runProgram(second, {"dream"}, out, err), kUsage);
}

}  // namespace
}  // namespace engram::apps
