// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/methods.h"
#include "eval_program.h"
#include "make_features.h"
#include "program_run.h"
#include "tours/room_lab.h"
#include "tours/tours_figures.h"
#include "tours/tours_run_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <set>
#include <sys/wait.h>
#include <unistd.h>

namespace engram::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<int> range(int from, int to) {
  std::vector<int> all(static_cast<std::size_t>(to - from));
  std::iota(all.begin(), all.end(), from);
  return all;
}

std::vector<int> joined(std::vector<int> a, const std::vector<int>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Features by identity: equal ones have equal descriptors and are seen in the same direction.
types::Features view(const std::vector<int>& identities) {
  auto features = memory::makeFeatures(identities, std::vector<float>(identities.size(), 1.0f));
  for (const int identity : identities) {
    base::Rng rng(77 + static_cast<std::uint64_t>(identity));
    Eigen::Vector3d ray(rng.normal(), rng.normal(), 0.5 * rng.normal());
    features.bearings.push_back(ray.normalized().cast<float>());
  }
  return features;
}

/// The same descriptors in directions that no motion of a camera explains.
types::Features scrambled(types::Features features, std::uint64_t seed) {
  base::Rng rng(seed);
  for (auto& ray : features.bearings)
    ray = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized().cast<float>();
  return features;
}

bool same(const memory::PlaceMemory& a, const memory::PlaceMemory& b) {
  return a.features.descriptors == b.features.descriptors && a.features.bearings == b.features.bearings &&
         a.states == b.states && a.updates == b.updates && a.nextFeatureId == b.nextFeatureId;
}

pipeline::PipelineParams paramsOf(const std::string& model) {
  pipeline::PipelineParams params;
  params.memory.memory = model;
  params.match.ratio = 0.5;  // the short descriptors of the examples agree by chance below the usual ratio
  return params;
}

TEST(TourPlaces, BracketTheRobotAcrossTheSeam) {
  const TourPlaces places({0.5, 3.0, 6.0, 9.9}, 12.0);
  const auto right = [&](double arc) {
    std::vector<int> list;
    for (int p = 0; p < 4; ++p)
      if (places.brackets(p, arc)) list.push_back(p);
    return list;
  };
  EXPECT_THAT(right(1.0), ElementsAre(0, 1));
  EXPECT_THAT(right(4.5), ElementsAre(1, 2));
  EXPECT_THAT(right(11.0), ElementsAre(0, 3));
  EXPECT_THAT(right(0.2), ElementsAre(0, 3));
  EXPECT_THAT(right(6.0), ElementsAre(2));  // on the place itself
  EXPECT_FALSE(places.brackets(-1, 1.0));   // no winner
  EXPECT_EQ(places.nearest(11.0), 3);
  EXPECT_EQ(places.nearest(11.9), 0);
  EXPECT_EQ(places.nearest(0.1), 0);
  EXPECT_EQ(places.nearest(4.5), 1);  // half-way: the lower number
}

// The image nearest to station 0 may lie before the seam; and the nearest place is always one of the two.
TEST(TourPlaces, HoldOnAnyRing) {
  base::Rng rng(5);
  for (int trial = 0; trial < 200; ++trial) {
    const double length = rng.uniform(5, 90);
    std::vector<double> arcs;
    for (int k = 0; k < 7; ++k)
      arcs.push_back(std::fmod(length * (k / 7.0 + rng.uniform(-0.05, 0.05)) + length, length));
    const TourPlaces places(arcs, length);
    const double arc = rng.uniform(0, length);
    std::set<int> passed;  // walking on from the robot and back from it, the first place met
    for (const int direction : {1, -1}) {
      double best = length;
      int first = -1;
      for (int k = 0; k < 7; ++k) {
        double way = direction * (arcs[static_cast<std::size_t>(k)] - arc);
        while (way < 0) way += length;
        if (way < best) best = way, first = k;
      }
      passed.insert(first);
    }
    for (int p = 0; p < 7; ++p) EXPECT_EQ(places.brackets(p, arc), passed.count(p) == 1) << trial;
    EXPECT_TRUE(places.brackets(places.nearest(arc), arc)) << trial;
  }
}

TEST(TourMemory, WinnerHasTheMostMatchesNotTheLargestShare) {
  TourMemory memory(paramsOf("static"), {view(range(0, 200)), view(range(300, 340))}, true);
  const TourQuery query = memory.see(view(joined(range(0, 60), range(300, 340))));
  EXPECT_EQ(query.winner, 0);  // 60 of 200 against 40 of 40
  EXPECT_EQ(query.matched, 60);
  EXPECT_EQ(query.features, 100);
  EXPECT_EQ(memory.see(view(joined(range(0, 39), range(300, 340)))).winner, 1);
  EXPECT_EQ(memory.see(view(joined(range(0, 40), range(300, 340)))).winner, 0);  // a tie: the lower number
  EXPECT_EQ(memory.see(view({})).winner, -1);
}

// Short-term features do not vote (D-03): 40 new ones at place 1, seen once, are no evidence for it yet.
TEST(TourMemory, OnlyLongTermFeaturesVote) {
  TourMemory memory(paramsOf("multi_store"), {view(range(0, 30)), view(range(100, 150))}, true);
  ASSERT_TRUE(memory.see(view(joined(range(100, 150), range(500, 540)))).learnt);
  ASSERT_EQ(memory.places()[1].longTerm().size(), 50u);
  ASSERT_EQ(memory.places()[1].features.size(), 90u);
  const TourQuery query = memory.see(view(joined(range(0, 30), range(500, 540))));
  EXPECT_EQ(query.winner, 0);
  EXPECT_EQ(query.matched, 30);
}

// D-E4, X-07: descriptors that agree in directions that do not must win and yet change nothing.
TEST(TourMemory, UnverifiedImagesNeverChangeAMemory) {
  for (const std::string model : {"multi_store", "fsh", "static", "replace"}) {
    TourMemory memory(paramsOf(model), {view(range(0, 80)), view(range(100, 180))}, true);
    const auto before = memory.places();
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const TourQuery query = memory.see(scrambled(view(joined(range(100, 170), range(900, 920))), seed));
      EXPECT_EQ(query.winner, 1);
      EXPECT_GE(query.matched, 60);
      EXPECT_EQ(query.verified, 0) << model << " " << seed;
      EXPECT_FALSE(query.learnt) << model << " " << seed;
    }
    for (std::size_t p = 0; p < 2; ++p) EXPECT_TRUE(same(memory.places()[p], before[p])) << model;
    // The same features in true directions are learnt, by the winner alone.
    const TourQuery query = memory.see(view(joined(range(100, 170), range(900, 920))));
    EXPECT_TRUE(query.learnt) << model;
    EXPECT_GE(query.verified, 60) << model;
    EXPECT_TRUE(same(memory.places()[0], before[0])) << model;
    EXPECT_EQ(same(memory.places()[1], before[1]), model == "static") << model;
  }
}

TEST(TourMemory, LearnsOncePerPassWhenAskedTo) {
  auto params = paramsOf("multi_store");
  params.memory.update_policy = "per_pass";
  const types::Features a = view(range(0, 80)), b = view(range(100, 180));
  TourMemory memory(params, {a, b}, true);
  memory.finishTour();
  EXPECT_TRUE(memory.see(a).learnt);
  EXPECT_FALSE(memory.see(a).learnt);
  EXPECT_TRUE(memory.see(b).learnt);
  EXPECT_TRUE(memory.see(a).learnt);
  EXPECT_FALSE(memory.see(a).learnt);
  memory.finishTour();
  EXPECT_TRUE(memory.see(a).learnt);
}

// What is seen on a tour does not depend on what was learnt on it.
TEST(TourMemory, LearnsAtTheEndOfTheTour) {
  const types::Features first = view(range(0, 80));
  const types::Features later = view(joined(range(0, 60), range(200, 230)));
  TourMemory late(paramsOf("replace"), {first}, false), atOnce(paramsOf("replace"), {first}, true);
  const auto before = late.places();
  EXPECT_TRUE(late.see(later).learnt);
  EXPECT_TRUE(same(late.places()[0], before[0]));
  EXPECT_EQ(late.see(later).matched, 60);
  late.finishTour();
  atOnce.see(later);
  EXPECT_EQ(atOnce.see(later).matched, 90);
  EXPECT_EQ(late.see(later).matched, 90);
}

/// Two tours of four images; places at 0, 3, 6 and 9 m of 12 m.
ToursRun handMade(const std::string& method, const std::vector<int>& winners,
                  const std::vector<int>& matched) {
  ToursRun run{method, 12.0, {0, 3, 6, 9}, {}};
  const std::vector<double> arcs{1, 4, 8, 11};
  for (int tour = 2; tour <= 3; ++tour) {
    TourRecord record{tour, tour - 1.0, "day", {}, {10, 0, 0, 0, 100}};
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t k = 4 * static_cast<std::size_t>(tour - 2) + i;
      record.queries.push_back({arcs[i], 600, winners[k], matched[k], matched[k] / 2, matched[k] > 50});
    }
    run.tours.push_back(record);
  }
  return run;
}

/// D-09 with truth: half of the room changes once. The static view matches the other half for ever; the
/// stores have the new half after four sightings and have dropped the old one after eight misses (D-E1).
TEST(Room, StoresFollowTheRoomAndAStaticViewDoesNot) {
  const types::Features before = view(range(0, 60)), after = view(joined(range(0, 30), range(100, 130)));
  std::vector<types::Features> views(11, before);
  views.insert(views.end(), 20, after);
  pipeline::PipelineParams params;
  params.match.max_distance = 0.3;  // no match by accident
  const auto results = roomResults(views, touredMethods(params), {}, 1);
  const auto of = [&](const std::string& method) {
    return *std::find_if(results.begin(), results.end(), [&](const auto& r) { return r.method == method; });
  };
  std::vector<int> halved(10, 60), followed(10, 60);
  halved.insert(halved.end(), 20, 30);
  followed.insert(followed.end(), 4, 30);
  followed.insert(followed.end(), 16, 60);
  EXPECT_EQ(of("static").matched, halved);
  EXPECT_EQ(of("multi_store_3_8").matched, followed);
  EXPECT_EQ(of("multi_store_3_8").learnt, 30);
  std::vector<int> longTerm(13, 60), shortTerm(10, 0);
  longTerm.insert(longTerm.end(), 4, 90);
  longTerm.insert(longTerm.end(), 13, 60);
  shortTerm.insert(shortTerm.end(), 3, 30);
  shortTerm.insert(shortTerm.end(), 17, 0);
  EXPECT_EQ(of("multi_store_3_8").longTerm, longTerm);
  EXPECT_EQ(of("multi_store_3_8").shortTerm, shortTerm);
  EXPECT_DOUBLE_EQ(of("static").mean.value, 40);
  EXPECT_NEAR(of("static").sigma, std::sqrt(200.0), 1e-9);
}

TEST(Room, TheRobotGoesBackAndForthAboutTheReferenceView) {
  const world::World world = world::World::preset("tiny", {});
  const RoomParams params;
  const world::Pose2 middle = world.route().at(5);
  double farthest = 0;
  for (int i = 0; i < 2 * params.period; ++i) {
    const world::Pose2 pose = roomPose(world.route(), 5, params, i);
    const double way = std::hypot(pose.x - middle.x, pose.y - middle.y);
    EXPECT_LE(way, params.reach + 1e-9);
    farthest = std::max(farthest, way);
    const world::Pose2 later = roomPose(world.route(), 5, params, i + params.period);
    EXPECT_NEAR(std::hypot(pose.x - later.x, pose.y - later.y), 0, 1e-6);
  }
  EXPECT_GT(farthest, 0.9 * params.reach);
  EXPECT_NEAR(std::hypot(roomPose(world.route(), 5, params, 0).x - middle.x, 0.0), 0, 1e-9);
}

TEST(ToursFigures, CountFailuresAndFewMatchesByTour) {
  // Right answers of the four images: 0|1, 1|2, 2|3, 3|0; the nearest: 0, 1, 3, 0.
  const auto still = handMade("static", {0, 3, 2, 1, 0, 1, 3, 0}, {100, 34, 35, 80, 100, 60, 20, 40});
  const auto other = handMade("multi_store_2_8", {0, 1, 2, 1, 1, 1, 3, 0}, {100, 36, 35, 80, 90, 60, 60, 40});
  const auto figures = figuresOf({other, still}, 35);
  ASSERT_EQ(figures.size(), 2u);
  const ToursFigure &a = figures[0], &s = figures[1];
  EXPECT_EQ(s.queries, 8);
  EXPECT_DOUBLE_EQ(s.failure.value, 2.0 / 8);  // images 2 and 4 of the first tour
  EXPECT_DOUBLE_EQ(s.strict.value, 3.0 / 8);   // and its image 3, which is nearer to place 3
  EXPECT_DOUBLE_EQ(s.few.value, 2.0 / 8);      // 34 and 20, not 35
  EXPECT_DOUBLE_EQ(s.fewVerified.value, 5.0 / 8);
  EXPECT_DOUBLE_EQ(s.matched.mean, 469.0 / 8);
  EXPECT_DOUBLE_EQ(s.learnt, 4.0 / 8);       // more than 50 matches
  EXPECT_DOUBLE_EQ(s.learntWrong, 1.0 / 4);  // image 4 of the first tour
  EXPECT_EQ(s.failure.blocks, 2);
  EXPECT_EQ(s.histogram.size(), 101u);
  EXPECT_EQ(s.histogram[100], 2);
  EXPECT_EQ(std::accumulate(s.histogram.begin(), s.histogram.end(), 0), 8);

  EXPECT_DOUBLE_EQ(a.failure.value, 1.0 / 8);
  EXPECT_DOUBLE_EQ(a.failureOver.value, -1.0 / 8);
  EXPECT_DOUBLE_EQ(a.fewOver.value, -2.0 / 8);
  EXPECT_EQ(a.failureOver.blocks, 2);
  // Each tour has one image less with few matches: the paired difference has no spread by tour.
  EXPECT_DOUBLE_EQ(a.fewOver.low, -2.0 / 8);
  EXPECT_DOUBLE_EQ(a.fewOver.high, -2.0 / 8);
  EXPECT_DOUBLE_EQ(s.failureOver.value, 0.0);

  EXPECT_TRUE(std::isnan(figuresOf({other}, 35).front().failureOver.value));
  EXPECT_THAT(toCsv({still}, 35), HasSubstr("static,2,1,4,2,3,1,"));
  EXPECT_THAT(toCsv({still}, 35), HasSubstr("static,3,2,4,0,0,1,"));
}

class ToursTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string name = (fs::temp_directory_path() / "engram_tours_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }
  static std::string path(const std::string& name) { return folder_ + "/" + name; }
  static std::string read(const std::string& name) {
    std::ifstream in(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  static RunResult tours(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"tours", "--quick", "--set", "drive.spacing=2"});
    return runAs<EvalProgram>(arguments);
  }
  /// The experiment that the tests start from.
  static void runOnce() {
    static const RunResult first =
        tours({"--out", path("one"), "--json", path("one.json"), "--threads", "1"});
    ASSERT_EQ(first.code, kOk) << first.err;
    EXPECT_THAT(first.out, HasSubstr("paper, static"));
  }

  static std::string folder_;
};
std::string ToursTest::folder_;

TEST_F(ToursTest, QuickRunWritesWholeFigures) {
  runOnce();
  const auto json = nlohmann::json::parse(read("one.json"));
  std::set<std::string> methods;
  for (const auto& f : json.at("tours")) {
    methods.insert(f.at("method").get<std::string>());
    for (const char* key : {"failure_rate", "failure_rate_strict", "share_under_35"}) {
      EXPECT_GE(f.at(key).get<double>(), 0);
      EXPECT_LE(f.at(key).get<double>(), 1);
    }
    EXPECT_LE(f.at("failure_rate").get<double>(), f.at("failure_rate_strict").get<double>());
    EXPECT_LE(f.at("failure_rate_95").at(0).get<double>(), f.at("failure_rate").get<double>());
    EXPECT_GE(f.at("failure_rate_95").at(1).get<double>(), f.at("failure_rate").get<double>());
    EXPECT_LE(f.at("mean_verified").get<double>(), f.at("mean_matched").get<double>());
  }
  EXPECT_EQ(methods,
            (std::set<std::string>{"multi_store_2_8", "multi_store_3_8", "fsh", "static", "replace"}));
  // Every share counted once more from the single images.
  for (const auto& f : json.at("tours")) {
    const ToursRun run = readToursRun(path("one/runs/" + f.at("method").get<std::string>() + ".json"));
    const auto way = [&](double from, double to) {
      return to < from ? to - from + run.tourLength : to - from;
    };
    double images = 0, failed = 0, few = 0, matched = 0;
    for (const TourRecord& tour : run.tours)
      for (const TourQuery& q : tour.queries) {
        double passed = 1e9, next = 1e9;  // way from the place behind, and to the one ahead
        int behind = -1, ahead = -1;
        for (std::size_t p = 0; p < run.placeArcs.size(); ++p) {
          const double since = way(run.placeArcs[p], q.arc), until = way(q.arc, run.placeArcs[p]);
          if (since < passed) passed = since, behind = static_cast<int>(p);
          if (until < next) next = until, ahead = static_cast<int>(p);
        }
        ++images;
        failed += q.winner != behind && q.winner != ahead;
        few += q.matched < 35;
        matched += q.matched;
      }
    EXPECT_EQ(f.at("queries").get<double>(), images);
    EXPECT_NEAR(f.at("failure_rate").get<double>(), failed / images, 1e-9);
    EXPECT_NEAR(f.at("share_under_35").get<double>(), few / images, 1e-9);
    EXPECT_NEAR(f.at("mean_matched").get<double>(), matched / images, 1e-9);
  }
  std::set<std::string> inTheRoom;
  for (const auto& f : json.at("room")) {
    inTheRoom.insert(f.at("method").get<std::string>());
    EXPECT_EQ(f.at("images"), 11);  // 12 with --quick, less the reference view
    EXPECT_GT(f.at("mean_matched").get<double>(), 0);
    if (f.at("method") == "static") {
      EXPECT_EQ(f.at("mean_ltm"), 600);
    }
  }
  EXPECT_EQ(inTheRoom, methods);
  const std::string csv = read("one/tours.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 5 * 3);  // methods, tours but the first

  // A static memory stays as it was made; a place that is replaced has what its last image had.
  for (const TourRecord& tour : readToursRun(path("one/runs/static.json")).tours) {
    EXPECT_EQ(tour.holdings.shortTerm, 0);
    EXPECT_EQ(tour.holdings.longTerm, 600);
  }
}

TEST_F(ToursTest, FiguresDoNotDependOnThreads) {
  runOnce();
  const RunResult two = tours({"--out", path("two"), "--json", path("two.json"), "--threads", "2", "-q"});
  ASSERT_EQ(two.code, kOk) << two.err;
  EXPECT_TRUE(two.out.empty());
  EXPECT_EQ(read("two/tours.csv"), read("one/tours.csv"));
  EXPECT_EQ(read("two.json"), read("one.json"));
  EXPECT_EQ(read("two/drives/tour_2.features"), read("one/drives/tour_2.features"));
}

// With all results there, no drive is needed; with a result gone, its drives are enough.
TEST_F(ToursTest, GoesOnFromWhatIsThere) {
  runOnce();
  const std::string csv = read("one/tours.csv"), figures = read("one.json");
  const auto rendered = fs::last_write_time(path("one/drives/tour_2.features"));
  fs::rename(path("one/drives"), path("drives"));
  ASSERT_EQ(tours({"--out", path("one"), "--json", path("again.json")}).code, kOk);
  EXPECT_FALSE(fs::exists(path("one/drives")));
  EXPECT_EQ(read("again.json"), figures);
  EXPECT_EQ(read("one/tours.csv"), csv);

  fs::rename(path("drives"), path("one/drives"));
  fs::remove(path("one/runs/fsh.json"));
  ASSERT_EQ(tours({"--out", path("one"), "--json", path("again.json")}).code, kOk);
  EXPECT_EQ(fs::last_write_time(path("one/drives/tour_2.features")), rendered);
  EXPECT_EQ(read("again.json"), figures);

  std::ofstream(path("one/runs/fsh.json")) << "{\"method\": \"fsh\", ";
  const RunResult damaged = tours({"--out", path("one")});
  EXPECT_EQ(damaged.code, kError);
  EXPECT_THAT(damaged.err, HasSubstr("fsh.json"));
  fs::remove(path("one/runs/fsh.json"));
  const RunResult other = tours({"--out", path("one"), "--set", "tours.places=5"});
  EXPECT_EQ(other.code, kError);
  EXPECT_THAT(other.err, HasSubstr("other settings"));
}

TEST_F(ToursTest, RefusesWhatItCannotUse) {
  EXPECT_EQ(tours({}).code, kUsage);
  const RunResult sudden = tours({"--out", path("bad"), "--set", "change.sudden_sessions=soon"});
  EXPECT_EQ(sudden.code, kError);
  EXPECT_THAT(sudden.err, HasSubstr("sudden_sessions"));
  EXPECT_EQ(tours({"--out", path("bad2"), "--set", "tours.tours=1"}).code, kError);
  EXPECT_EQ(tours({"--no-such"}).code, kUsage);
}

TEST_F(ToursTest, StopsWhenInterrupted) {
  const std::string command = "timeout --preserve-status -s INT 2 " ENGRAM_BIN_DIR
                              "/engram-eval tours --out " +
                              path("stopped") + " 2> " + path("messages");
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), kPartial) << read("messages");
  EXPECT_THAT(read("messages"), HasSubstr("what was done is kept"));
  EXPECT_TRUE(fs::exists(path("stopped/experiment.ini")));
  EXPECT_TRUE(fs::is_empty(path("stopped/runs")));
}

}  // namespace
}  // namespace engram::apps
