// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/config.h"

#include "engram/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace engram::base {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

struct Robot {
  double speed = 0.5;
  int wheels = 2;
  bool lamp = false;
  std::string name = "hal";
  std::string drive = "diff";
  double tilt = 0.0;

  void describe(Params& p) {
    p.add("speed", speed, "largest speed [m/s]", {0, 3});
    p.add("wheels", wheels, "number of wheels", atLeast(1));
    p.add("lamp", lamp, "whether the lamp is on");
    p.add("name", name, "how it is called");
    p.addChoice("drive", drive, "kind of drive", {"diff", "omni"});
    p.addDegrees("tilt", tilt, "tilt of the camera [deg]", {-90, 90});
  }
};

struct Fixture {
  Robot robot, other;
  Config config;
  Fixture() {
    config.bind("robot", robot);
    config.bind("other", other);
  }
  void read(const std::string& text) { config.read(IniFile::parse(text, "r.ini")); }
};

void refuses(const std::string& text, const std::string& message) {
  Fixture f;
  EXPECT_THAT([&] { f.read(text); }, ThrowsMessage<ConfigError>(message)) << text;
}

TEST(IniFile, ReadsSectionsKeysAndCommentsOfMrpt) {
  const auto ini = IniFile::parse(
      "# first\n; second\n// third\n\n[ a ]\r\n x = 1 2 # tail\n\ty=http://b;c // tail\n[b]\nempty =\n[a]\nz "
      "= 3\n",
      "f");
  ASSERT_EQ(ini.sections().size(), 2u);
  const auto& a = ini.sections().at("a");
  EXPECT_EQ(a.at("x").text, "1 2");
  EXPECT_EQ(a.at("x").origin, "f:6");
  EXPECT_EQ(a.at("y").text, "http://b;c");
  EXPECT_EQ(a.at("z").text, "3");
  EXPECT_EQ(ini.sections().at("b").at("empty").text, "");
}

TEST(IniFile, RefusesLinesThatAreNeither) {
  const auto refusesText = [](const std::string& text, const std::string& message) {
    EXPECT_THAT([&] { IniFile::parse(text, "f"); }, ThrowsMessage<ConfigError>(message));
  };
  refusesText("[a]\nhello\n", "f:2: 'hello' is neither [section] nor key = value");
  refusesText("[a\n", "f:1: '[a' lacks the closing ']'");
  refusesText("x = 1\n", "f:1: a key before the first [section]");
  refusesText("[a]\nx = 1\n\n[a]\nx = 2\n", "f:5: [a] x was set before, at f:2");
}

TEST(IniFile, LoadsAFileAndNamesAMissingOne) {
  const auto path = std::filesystem::temp_directory_path() / "engram_config_test.ini";
  std::ofstream(path) << "[robot]\nspeed = 2\n";
  EXPECT_EQ(IniFile::load(path).sections().at("robot").at("speed").origin, path.string() + ":2");
  std::filesystem::remove(path);
  EXPECT_THAT([&] { IniFile::load(path); },
              ThrowsMessage<ConfigError>(path.string() +
                                         ": cannot be opened; does the file exist and may you read it?"));
}

TEST(Config, SetsEveryKindOfValue) {
  Fixture f;
  f.read("[robot]\nspeed = +1.25e0\nwheels = 4\nlamp = yes\nname = R2 D2\ndrive = omni\ntilt = -30\n");
  EXPECT_EQ(f.robot.speed, 1.25);
  EXPECT_EQ(f.robot.wheels, 4);
  EXPECT_TRUE(f.robot.lamp);
  EXPECT_EQ(f.robot.name, "R2 D2");
  EXPECT_EQ(f.robot.drive, "omni");
  EXPECT_NEAR(f.robot.tilt, -std::numbers::pi / 6, 1e-15);
  EXPECT_EQ(f.other.speed, 0.5) << "the other section is another struct";
}

TEST(Config, KeepsDefaultsForWhatIsNotGiven) {
  Fixture f;
  f.read("[robot]\n");
  EXPECT_EQ(f.robot.speed, 0.5);
  EXPECT_EQ(f.robot.name, "hal");
}

TEST(Config, RefusesUnknownNamesAndSuggestsTheNearest) {
  refuses("[robot]\nsped = 1\n", "r.ini:2: [robot] sped: unknown key; did you mean 'speed'?");
  refuses("[robot]\nantigravity = 1\n",
          "r.ini:2: [robot] antigravity: unknown key; --dump-config lists the known ones");
  refuses("[robt]\nspeed = 1\n", "r.ini:2: unknown section [robt]; did you mean 'robot'?");
  refuses("[zzzzzzzz]\nspeed = 1\n",
          "r.ini:2: unknown section [zzzzzzzz]; --dump-config lists the known ones");
  refuses("[robt]\n", "r.ini: unknown section [robt]; did you mean 'robot'?");
}

TEST(Config, RefusesWhatIsNotWhollyAValue) {
  for (const char* bad : {"abc", "12abc", "1,5", "", "1 2", "0x10", "--1", "+-1", "nan", "inf", "1e999"}) {
    Fixture f;
    EXPECT_THAT(
        [&] { f.read(std::string("[robot]\nspeed = ") + bad + "\n"); },
        ThrowsMessage<ConfigError>(std::string("r.ini:2: [robot] speed: '") + bad + "' is not a number"));
  }
  for (const char* bad : {"2.5", "4.0", "99999999999", "two", "+-1"}) {
    Fixture f;
    EXPECT_THAT([&] { f.read(std::string("[robot]\nwheels = ") + bad + "\n"); },
                ThrowsMessage<ConfigError>(std::string("r.ini:2: [robot] wheels: '") + bad +
                                           "' is not a whole number"));
  }
  refuses("[robot]\nlamp = maybe\n", "r.ini:2: [robot] lamp: 'maybe' is neither true nor false");
  refuses("[robot]\ntilt = up\n", "r.ini:2: [robot] tilt: 'up' is not a number");
}

TEST(Config, RefusesValuesOutOfRangeAndNamesTheBound) {
  refuses("[robot]\nspeed = 3.5\n", "r.ini:2: [robot] speed: 3.5 is out of range: must be in [0, 3]");
  refuses("[robot]\nwheels = 0\n", "r.ini:2: [robot] wheels: 0 is out of range: must be >= 1");
  refuses("[robot]\ndrive = legs\n", "r.ini:2: [robot] drive: 'legs' is not one of diff | omni");
  refuses("[robot]\ntilt = 91\n", "r.ini:2: [robot] tilt: 91 is out of range: must be in [-90, 90]");
}

TEST(Config, AcceptsTheBoundsThemselves) {
  Fixture f;
  f.read("[robot]\nspeed = 3\nwheels = 1\ntilt = 90\n");
  f.read("[robot]\nspeed = 0\ntilt = -90\n");
  EXPECT_EQ(f.robot.speed, 0);
}

TEST(Config, ReadsItsOwnDump) {
  Fixture f;
  f.read(
      "[robot]\nspeed = 0.1\nlamp = 1\nname = a b\ntilt = 10\n[other]\nwheels = 7\ndrive = omni\nname =\n");
  const std::string text = f.config.dump();
  EXPECT_THAT(text, HasSubstr("[robot]\n# largest speed [m/s]\nspeed = 0.1\n"));
  EXPECT_THAT(text, HasSubstr("# tilt of the camera [deg]\ntilt = 10\n"));
  EXPECT_THAT(text, HasSubstr("# kind of drive (diff | omni)\ndrive = omni\n"));
  Fixture g;
  g.read(text);
  EXPECT_EQ(g.config.dump(), text);
  EXPECT_EQ(g.robot.speed, 0.1);
  EXPECT_EQ(g.robot.tilt, f.robot.tilt);
  EXPECT_EQ(g.other.wheels, 7);
  EXPECT_EQ(g.other.name, "");
}

TEST(Config, PrintsNumbersSoThatTheyReadBackExactly) {
  for (const double value : {0.1, 1.0 / 3, 2.9999999999999996, 1e-300, 0.0}) {
    Fixture f, g;
    f.robot.speed = value;
    g.read(f.config.dump());
    EXPECT_EQ(g.robot.speed, value);
  }
}

TEST(Config, BindsTwoStructsToOneSection) {
  struct Extra {
    double range = 9;
    void describe(Params& p) { p.add("range", range, "of the radio [m]"); }
  };
  Robot robot;
  Extra extra;
  Config config;
  config.bind("robot", robot);
  config.bind("robot", extra);
  config.read(IniFile::parse("[robot]\nspeed = 1\nrange = 4\n", "f"));
  EXPECT_EQ(robot.speed, 1);
  EXPECT_EQ(extra.range, 4);
}

TEST(CommandLine, SetsOnTopOfTheFile) {
  auto ini = IniFile::parse("[robot]\nspeed = 1\n", "f");
  ini.override("robot.speed=2");
  ini.override("other.name = a=b.c");
  Fixture f;
  f.config.read(ini);
  EXPECT_EQ(f.robot.speed, 2);
  EXPECT_EQ(f.other.name, "a=b.c");
}

TEST(CommandLine, RefusesWithItsOwnName) {
  for (const char* bad : {"robot.speed", "speed=1", "=", "a=b.c"}) {
    IniFile ini;
    EXPECT_THAT([&] { ini.override(bad); },
                ThrowsMessage<ConfigError>(std::string("--set '") + bad + "': expected section.key=value"));
  }
  IniFile ini;
  ini.override("robot.speed=fast");
  Fixture f;
  EXPECT_THAT([&] { f.config.read(ini); },
              ThrowsMessage<ConfigError>("--set: [robot] speed: 'fast' is not a number"));
}

TEST(NearestName, IsTheOneWithTheFewestEdits) {
  const std::vector<std::string> known{"threshold", "sigma", "max_features", "min_features"};
  EXPECT_EQ(nearestName("treshold", known), "threshold");
  EXPECT_EQ(nearestName("simga", known), "sigma");
  EXPECT_EQ(nearestName("max_feature", known), "max_features");
  EXPECT_EQ(nearestName("sigma", known), "sigma");
  EXPECT_EQ(nearestName("completely_else", known), "");
  EXPECT_EQ(nearestName("x", {}), "");
}

}  // namespace
}  // namespace engram::base
