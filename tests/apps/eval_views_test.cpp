// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/store/map_file.h"
#include "eval_program.h"
#include "program_run.h"
#include "views/views_report.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <unistd.h>

namespace engram::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

RunResult views(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "views");
  return runAs<EvalProgram>(arguments);
}

/// Figures without what depends on the machine.
nlohmann::json timeless(nlohmann::json j) {
  if (j.is_object()) {
    for (const char* key : {"ms_per_image", "ms_per_view", "step_ms"}) j.erase(key);
    for (auto& [key, value] : j.items()) value = timeless(value);
  } else if (j.is_array()) {
    for (auto& value : j) value = timeless(value);
  }
  return j;
}

class ViewsTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / ("engram_views_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    first_ = views({"--quick", "--out", path("a"), "--json", path("a.json"), "--threads", "2"});
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }
  static std::string path(const std::string& name) { return (folder_ / name).string(); }
  static nlohmann::json json(const std::string& name) {
    std::ifstream in(path(name));
    return nlohmann::json::parse(in);
  }
  static fs::path folder_;
  static RunResult first_;
};
fs::path ViewsTest::folder_;
RunResult ViewsTest::first_;

TEST_F(ViewsTest, MakesMapsOfAllDrivesAndSaysHowGoodTheyAre) {
  ASSERT_EQ(first_.code, kOk) << first_.err;
  const auto j = json("a.json");
  EXPECT_EQ(j.at("sequences"), 2);
  EXPECT_GT(j.at("views").get<int>(), 20);
  EXPECT_GT(j.at("links").get<int>(), 20);
  EXPECT_EQ(j.at("false_links"), 0);
  EXPECT_EQ(j.at("parts"), 1 + j.at("weak_links_left").get<int>())
      << "weak links hold what nothing else holds";
  EXPECT_LT(j.at("ate_percent").get<double>(), 2.0);
  EXPECT_EQ(j.at("ate_apart").get<double>() > 0, j.at("parts").get<int>() > 1);
  EXPECT_EQ(j.at("random_orders").at("runs").size(), 2u);
  EXPECT_EQ(j.at("repair").at("covers"), 2);
  EXPECT_GE(j.at("repair").at("session").at("weak_links_made").get<int>(), 1) << "covered eyes";
  EXPECT_GT(j.at("repair").at("after").at("right").get<int>(), 0);
  EXPECT_EQ(j.at("kappa_table").size(), 1u);
  EXPECT_EQ(j.at("recognition").at(0).at("recognised"), j.at("recognition").at(0).at("tried"))
      << "a view is recognised where it was taken";
  for (const auto& spot : j.at("spots")) EXPECT_LE(spot.at("views").back().get<int>(), 6) << spot.at("name");
  const auto& forgetting = j.at("lifelong").at(1).at("sessions").back();
  const auto& keeping = j.at("lifelong").at(0).at("sessions").back();
  EXPECT_LE(forgetting.at("views").get<int>(), keeping.at("views").get<int>());
  EXPECT_THAT(first_.out, HasSubstr("sequences  2 drives"));
  for (const char* file : {"a/index.html", "a/sessions.csv", "a/offsets.csv"})
    EXPECT_TRUE(fs::exists(path(file)));
  for (const auto& map : fs::directory_iterator(path("a/maps")))
    EXPECT_THAT(store::MapFile::open(map.path().string(), store::Access::kReadOnly).check(), IsEmpty());
}

TEST_F(ViewsTest, TheSameAgainWhateverTheThreads) {
  ASSERT_EQ(first_.code, kOk);
  ASSERT_EQ(views({"--quick", "-q", "--out", path("a"), "--json", path("b.json"), "--threads", "1"}).code,
            kOk);
  EXPECT_EQ(timeless(json("a.json")), timeless(json("b.json")));
}

TEST_F(ViewsTest, DefaultsAreThoseOfItsConfiguration) {
  const std::vector<std::string> noCamera{"--dump-config", "--set", "camera.file="};
  auto withFile = noCamera;
  withFile.insert(withFile.end(), {"--config", ENGRAM_SOURCE_DIR "/config/view_map.ini"});
  const RunResult plain = views(noCamera), file = views(withFile);
  ASSERT_EQ(plain.code, kOk);
  EXPECT_EQ(plain.out, file.out);
  EXPECT_THAT(plain.out, HasSubstr("nodes = views"));
}

TEST_F(ViewsTest, RefusesWhatItCannotUse) {
  EXPECT_EQ(views({"--quick"}).code, kUsage);  // no --out
  const RunResult kappas = views({"--quick", "--out", path("x"), "--set", "views_world.kappas=2,many"});
  EXPECT_EQ(kappas.code, kError);
  EXPECT_THAT(kappas.err, HasSubstr("'many' is no whole number"));
  const RunResult camera = views({"--quick", "--out", path("y"), "--set", "camera.file=/no/such/camera.ini"});
  EXPECT_EQ(camera.code, kError);
  EXPECT_THAT(camera.err, HasSubstr("/no/such/camera.ini"));
  EXPECT_EQ(views({"--quick", "--out", path("a"), "--seed", "9"}).code, kError) << "other settings";
}

TEST(Views, CoversLieApartAndInsideTheDrive) {
  KeptDrive drive;
  for (int i = 0; i < 500; ++i) drive.arcs.push_back(0.1 * i);
  const auto covers = coversOf(drive, 20, 1.5, 3);
  ASSERT_EQ(covers.size(), 20u);
  std::size_t end = 0;
  for (const auto& [first, last] : covers) {
    EXPECT_GT(first, end);
    EXPECT_GE(last, first + 2);
    EXPECT_LT(last, drive.arcs.size());
    end = last;
  }
}

TEST(Views, SpreadOfOrders) {
  OrderedRun a, b;
  a.sessions.resize(1);
  b.sessions.resize(1);
  a.sessions[0].views = 90;
  b.sessions[0].views = 110;
  a.ate = 0.1;
  b.ate = 0.13;
  EXPECT_NEAR(orderFigures({a, b}).viewsSpread, 0.2, 1e-12);
  EXPECT_NEAR(orderFigures({a, b}).ateRatioMax, 1.3, 1e-12);
}

}  // namespace
}  // namespace engram::apps
