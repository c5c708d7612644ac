// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/error.h"
#include "engram/evaluation/trajectory.h"
#include "eval_program.h"
#include "program_run.h"
#include "words/words_localisation.h"
#include "words/words_protocol.h"
#include "words/words_run_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <unistd.h>

namespace engram::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

const PassAnswer kFound{true, true, true, true}, kAstray{true, false, false, true};
const PassAnswer kGeometry{false, false, true, true}, kUnsure{false, false, true, false};
const PassAnswer kLost{false, false, false, true};

/// Plays a list of answers and notes what was asked.
struct Script {
  std::vector<PassAnswer> answers;
  std::vector<std::size_t> asked, restarts;

  AskImage ask() {
    return [this](std::size_t i, bool restart) {
      asked.push_back(i);
      if (restart) restarts.push_back(i);
      return answers.at(i);
    };
  }
  Attempt from(std::size_t start) { return attemptFrom(start, answers.size(), ask()); }
};

TEST(WordsProtocol, CountsTrialsAndTrackings) {
  Script s{{kUnsure, kLost, kFound, kFound, kFound, kGeometry, kFound}, {}, {}};
  const Attempt a = s.from(0);
  EXPECT_EQ(a.trials, 3);  // with the one that was accepted
  EXPECT_TRUE(a.located);
  EXPECT_EQ(a.trackings, 2);  // without it
  EXPECT_EQ(a.end, Miss::kGeometry);
  EXPECT_EQ(a.accepted, 3);
  EXPECT_EQ(a.wrong, 0);
  EXPECT_THAT(a.misses, ElementsAre(1, 1, 1, 0, 0));
  EXPECT_THAT(s.asked, ElementsAre(0, 1, 2, 3, 4, 5));  // nothing after the loss
  EXPECT_THAT(s.restarts, ElementsAre(0));

  EXPECT_EQ(s.from(3).trials, 1);  // found at once
  EXPECT_EQ(s.from(3).trackings, 1);
  EXPECT_EQ(s.from(6).trackings, 0);
  EXPECT_EQ(s.from(6).end, Miss::kEndOfDrive);
}

TEST(WordsProtocol, AWrongAcceptanceEndsTheSearchAndTheTracking) {
  Script search{{kUnsure, kAstray, kFound}, {}, {}};
  const Attempt a = search.from(0);
  EXPECT_FALSE(a.located);
  EXPECT_EQ(a.end, Miss::kWrongAccept);
  EXPECT_EQ(a.accepted, 1);
  EXPECT_EQ(a.wrong, 1);
  EXPECT_THAT(search.asked, ElementsAre(0, 1));

  Script track{{kFound, kFound, kAstray, kFound}, {}, {}};
  const Attempt b = track.from(0);
  EXPECT_TRUE(b.located);
  EXPECT_EQ(b.trackings, 1);
  EXPECT_EQ(b.end, Miss::kWrongAccept);
  EXPECT_EQ(b.wrong, 1);
  EXPECT_EQ(b.accepted, 3);
}

TEST(WordsProtocol, TellsWhyAnImageWasMissed) {
  EXPECT_EQ(missOf(kGeometry), Miss::kGeometry);
  EXPECT_EQ(missOf(kUnsure), Miss::kUnsure);
  EXPECT_EQ(missOf(kLost), Miss::kWrongGuess);
  EXPECT_EQ(missOf({false, false, false, false}), Miss::kWrongGuess);
  EXPECT_EQ(missOf(kAstray), Miss::kWrongAccept);
}

TEST(WordsProtocol, FiguresByHand) {
  Script s{{kFound, kFound, kGeometry,  // from 0: 1 trial, 1 tracking
            kUnsure, kFound, kUnsure,   // from 3: 2 trials, 0 trackings
            kLost, kAstray,             // from 6: wrong
            kUnsure, kLost},            // from 8: never
           {},
           {}};
  const ProtocolFigures f = figuresOf({s.from(0), s.from(3), s.from(6), s.from(8)});
  EXPECT_EQ(f.attempts, 4);
  EXPECT_EQ(f.never, 1);
  EXPECT_EQ(f.trials.count, 2);
  EXPECT_DOUBLE_EQ(f.trials.mean, 1.5);
  EXPECT_DOUBLE_EQ(f.trials.std, 0.5);
  EXPECT_DOUBLE_EQ(f.trackings.mean, 0.5);
  EXPECT_EQ(f.accepted, 4);
  EXPECT_EQ(f.wrong, 1);
  EXPECT_DOUBLE_EQ(f.wrongShare(), 0.25);
  EXPECT_THAT(f.misses, ElementsAre(1, 3, 2, 0, 0));
  EXPECT_THAT(f.ends, ElementsAre(1, 1, 0, 0, 0));
  EXPECT_EQ(figuresOf(std::vector<Attempt>{}).trials.count, 0);
  EXPECT_EQ(meanStd({}).mean, 0);
}

TEST(WordsProtocol, DrawsFirstImagesUniformlyFromTheSeed) {
  const std::vector<PassAnswer> found(10, kFound);
  const auto startsOf = [&](std::uint64_t seed) {
    Script s{found, {}, {}};
    std::vector<std::size_t> starts;
    for (const Attempt& a : attempts(2000, found.size(), seed, s.ask())) {
      starts.push_back(a.start);
      EXPECT_EQ(a.trackings, static_cast<int>(found.size() - a.start) - 1);
    }
    return starts;
  };
  const auto starts = startsOf(4);
  EXPECT_EQ(starts, startsOf(4));
  EXPECT_NE(starts, startsOf(5));
  for (std::size_t i = 0; i < found.size(); ++i)  // 200 each, five sigma
    EXPECT_NEAR(static_cast<double>(std::count(starts.begin(), starts.end(), i)), 200, 68);
  Script none;
  EXPECT_THROW(attempts(1, 0, 1, none.ask()), base::Error);
}

TEST(WordsTransitions, ChangeTheConfiguration) {
  pipeline::PipelineParams params;
  params.recognise.accept_inliers = 17;
  std::set<std::string> names;
  for (const Transition& t : transitions()) {
    EXPECT_TRUE(names.insert(t.name).second) << t.name;
    EXPECT_EQ(with(t, params).recognise.accept_inliers, 17);  // all else stays
  }
  const Transition& blind = transitions().front();
  EXPECT_EQ(blind.name, "blind");
  EXPECT_FALSE(blind.odometry);
  EXPECT_EQ(with(blind, params).belief.advance, "none");
  EXPECT_EQ(with(blind, params).belief.expected_hops, 1);
  EXPECT_THROW(with({"wild", "", true, {"belief.no_such_key=1"}}, params), base::Error);
}

/// One quick experiment that the tests look at.
class WordsWorldTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string name = (fs::temp_directory_path() / "engram_words_world_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    first_ = words({"--quick", "--threads", "2", "--out", path("a"), "--json", path("a.json")});
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }
  static std::string path(const std::string& name) { return folder_ + "/" + name; }
  static RunResult words(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "words");
    return runAs<EvalProgram>(arguments);
  }
  static std::string read(const std::string& name) {
    std::ifstream in(path(name));
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static nlohmann::json json(const std::string& name) { return nlohmann::json::parse(read(name)); }
  /// Figures without processor times, which are never the same.
  static nlohmann::json timeless(nlohmann::json figures) {
    for (auto& m : figures.at("mapping")) {
      m.erase("cpu_seconds");
      m.erase("relaxation_cpu_seconds");
    }
    for (auto& l : figures.at("localisation")) l.erase("ms_per_image");
    return figures;
  }

  static std::string folder_;
  static RunResult first_;
};
std::string WordsWorldTest::folder_;
RunResult WordsWorldTest::first_;

TEST_F(WordsWorldTest, MapsAndLocates) {
  ASSERT_EQ(first_.code, kOk) << first_.err;
  const auto figures = json("a.json");
  ASSERT_EQ(figures.at("mapping").size(), 1u);
  const auto& m = figures.at("mapping").front();
  EXPECT_EQ(m.at("building"), "tiny");
  EXPECT_NEAR(m.at("length_m").get<double>(), 40, 6);  // two laps
  EXPECT_GE(m.at("true_closures").get<int>(), 1);
  EXPECT_EQ(m.at("false_closures"), 0);
  EXPECT_EQ(m.at("recognised_wrong"), 0);
  EXPECT_GE(m.at("images").get<int>(), m.at("places").get<int>() + m.at("recognised").get<int>());
  for (const char* relaxer : {"ceres", "duckett", "mrpt_levmarq"})
    EXPECT_LT(m.at("ate_after_m").at(relaxer).get<double>(), m.at("ate_odometry_m").get<double>());
  EXPECT_LT(m.at("ate_after_m").at("ceres").get<double>(), m.at("ate_before_m").get<double>());
  EXPECT_GT(m.at("cpu_seconds").get<double>(), 0);

  ASSERT_EQ(figures.at("localisation").size(), transitions().size());
  for (std::size_t k = 0; k < transitions().size(); ++k) {
    const auto& l = figures.at("localisation").at(k);
    EXPECT_EQ(l.at("setting"), "indoor");
    EXPECT_EQ(l.at("transition"), transitions()[k].name);
    EXPECT_EQ(l.at("attempts"), 20);
    EXPECT_EQ(l.at("wrong"), 0.0);
    EXPECT_GE(l.at("trials").at("mean").get<double>(), 1);
    EXPECT_LE(l.at("trials").at("mean").get<double>(), 5);
    EXPECT_GT(l.at("trackings").at("mean").get<double>(), 1);
    EXPECT_GT(l.at("ms_per_image").get<double>(), 0);
  }
}

/// The distances in the list of closures, from the truth beside the rawlog.
TEST_F(WordsWorldTest, ClosuresAreJudgedByTheTruth) {
  const auto truth = evaluation::readTum(path("a/drives/tiny.truth.tum"));
  for (const auto& c : json("a.json").at("mapping").front().at("closures")) {
    const auto& robot = truth.at(c.at("image").get<std::size_t>()).T_world_body.translation();
    const auto& place = truth.at(c.at("place_image").get<std::size_t>()).T_world_body.translation();
    EXPECT_NEAR(c.at("distance_m").get<double>(), (robot - place).norm(), 1e-6);
    EXPECT_EQ(c.at("right").get<bool>(), (robot - place).norm() <= 1.5);
    EXPECT_TRUE(c.at("kept").get<bool>());
    EXPECT_GT(c.at("image").get<int>(), c.at("place_image").get<int>());
  }
}

TEST_F(WordsWorldTest, WritesTablesAndAPage) {
  EXPECT_THAT(first_.out, HasSubstr("tiny"));
  EXPECT_THAT(first_.out, HasSubstr("5 (4)"));
  const std::string page = read("a/index.html");
  EXPECT_THAT(page, HasSubstr("</svg>"));
  EXPECT_THAT(page, HasSubstr("Relaxed"));
  const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
  EXPECT_EQ(lines(read("a/mapping.csv")), 2);
  EXPECT_EQ(lines(read("a/closures.csv")),
            1 + static_cast<int>(json("a.json").at("mapping").front().at("closures").size()));
  EXPECT_EQ(lines(read("a/localisation.csv")), 1 + static_cast<int>(transitions().size()));
  EXPECT_EQ(lines(read("a/attempts.csv")), 1 + 20 * static_cast<int>(transitions().size()));
}

// The same figures from the same drives with one thread, and from what an interrupted experiment left.
TEST_F(WordsWorldTest, IsDeterministicAndGoesOn) {
  fs::create_directory(path("b"));
  fs::copy(path("a/drives"), path("b/drives"));
  ASSERT_EQ(words({"--quick", "-q", "--threads", "1", "--out", path("b"), "--json", path("b.json")}).code,
            kOk);
  EXPECT_EQ(timeless(json("a.json")), timeless(json("b.json")));
  EXPECT_EQ(read("a/attempts.csv"), read("b/attempts.csv"));

  const std::string kept = path("b/runs/mapping_tiny.json");
  const auto before = fs::last_write_time(kept);
  ASSERT_EQ(fs::remove(path("b/runs/localisation_tiny_blind.json")), true);
  ASSERT_EQ(words({"--quick", "-q", "--threads", "1", "--out", path("b"), "--json", path("c.json")}).code,
            kOk);
  EXPECT_EQ(timeless(json("b.json")), timeless(json("c.json")));
  EXPECT_EQ(fs::last_write_time(kept), before);

  std::ofstream(path("b/runs/mapping_tiny.json")) << "{\"building\": ";
  const RunResult damaged = words({"--quick", "-q", "--out", path("b")});
  EXPECT_EQ(damaged.code, kError);
  EXPECT_THAT(damaged.err, HasSubstr("mapping_tiny.json is not whole"));
}

TEST_F(WordsWorldTest, DefaultsAreThoseOfItsConfiguration) {
  const std::vector<std::string> noCamera{"--dump-config", "--set", "camera.file="};
  auto withFile = noCamera;
  withFile.insert(withFile.end(), {"--config", ENGRAM_SOURCE_DIR "/config/words_odometry.ini"});
  const RunResult plain = words(noCamera), file = words(withFile);
  ASSERT_EQ(plain.code, kOk);
  EXPECT_EQ(plain.out, file.out);
  EXPECT_THAT(plain.out, HasSubstr("min_distance = 0.5"));
  const RunResult whole =
      words({"--dump-config", "--config", ENGRAM_SOURCE_DIR "/config/words_odometry.ini"});
  EXPECT_THAT(whole.out, HasSubstr("pinhole_world.ini"));
}

TEST_F(WordsWorldTest, RefusesWhatItCannotUse) {
  const RunResult truth = words({"--truth", "t.csv", "--out", path("x")});
  EXPECT_EQ(truth.code, kUsage);
  EXPECT_THAT(truth.err, HasSubstr("--truth belongs to --images"));
  EXPECT_THAT(words({"--stops", "2", "--out", path("x")}).err, HasSubstr("--stops"));
  const RunResult none = words({"--out", path("x"), "--set", "words_world.attempts=0"});
  EXPECT_EQ(none.code, kError);
  EXPECT_THAT(none.err, HasSubstr("attempts"));
  EXPECT_EQ(words({"--quick"}).code, kUsage);  // no --out
  const RunResult camera = words({"--quick", "--out", path("y"), "--set", "camera.file=/no/such/camera.ini"});
  EXPECT_EQ(camera.code, kError);
  EXPECT_THAT(camera.err, HasSubstr("/no/such/camera.ini"));
  const RunResult other = words({"--quick", "--out", path("a"), "--seed", "9"});
  EXPECT_EQ(other.code, kError);
  EXPECT_THAT(other.err, HasSubstr("other settings"));
}

}  // namespace
}  // namespace engram::apps
