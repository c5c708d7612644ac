// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/program.h"
#include "engram/store/map_file.h"
#include "rawlog_fixture.h"
#include "run_fixture.h"

#include <gmock/gmock.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <limits>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace engram::apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
namespace fs = std::filesystem;
namespace raw = engram::sources::test;

class SlamTest : public RunTest {
 protected:
  /// The message of a run that must fail with code 1 and without a map; empty when it did not.
  std::string refusal(std::vector<std::string> arguments) const {
    const RunResult result = slam(arguments);
    EXPECT_EQ(result.code, kError) << result.out << result.err;
    return result.err;
  }
};

TEST_F(SlamTest, TheTruthOfAnotherDriveIsRefusedAndTheMapKept) {
  const RunResult result =
      slam({config(), "--rawlog", rawlog(1), "--map", path("m.engram"), "--truth", truth(2), "-q"});
  EXPECT_EQ(result.code, kError);
  EXPECT_THAT(result.err, AllOf(HasSubstr("2.tum: is not the truth of these images"),
                                HasSubstr("of 38 images"), HasSubstr("What else was done is kept")));
  EXPECT_EQ(soundImages(path("m.engram")), 38u);
  writeBytes(path("links.csv"), "a,b\n1,2\n2,3\n");
  const RunResult unnamed =
      slam({config(), "--rawlog", rawlog(1), "--map", path("n.engram"), "--truth", path("links.csv"), "-q"});
  EXPECT_EQ(unnamed.code, kError);
  EXPECT_THAT(unnamed.err, HasSubstr("38 images have none (their label is 'CAMERA')"));
}

TEST_F(SlamTest, MapsADriveAndSaysSo) {
  const RunResult result = slam({config(), "--rawlog", rawlog(1), "--map", path("m.engram"), "--truth",
                                 truth(1), "--json", path("m.json")});
  ASSERT_EQ(result.code, kOk) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("38 images"), HasSubstr("places"), HasSubstr("(0 false)")));
  const auto j = jsonOf(path("m.json"));
  for (const char* key : {"images", "keyframes", "unusable", "refused", "places", "views", "edges",
                          "closures", "false_closures", "closure_list", "ate_m", "map_bytes",
                          "bytes_per_place", "ms_per_image", "peak_rss_bytes"})
    EXPECT_TRUE(j.contains(key)) << key;
  for (const char* key : {"mean", "median", "p95", "max"}) EXPECT_GT(j["ms_per_image"][key], 0) << key;
  EXPECT_EQ(j["images"], 38);
  EXPECT_EQ(j["unusable"], 0);
  EXPECT_EQ(j["false_closures"], 0);
  EXPECT_LT(j["ate_m"], 0.5);
  EXPECT_EQ(j["map_bytes"], fs::file_size(path("m.engram")));
  EXPECT_EQ(soundImages(path("m.engram")), 38u);
  EXPECT_FALSE(fs::exists(path("m.engram-wal")));
}

TEST_F(SlamTest, QuietIsSilentAndFiguresWithoutTruthAreNull) {
  writeRawlog(path("a.rawlog"), firstFrames(3));
  const RunResult result = slam({config(), "--rawlog", path("a.rawlog"), "--json", path("m.json"), "-q"});
  EXPECT_EQ(result.code, kOk);
  EXPECT_THAT(result.out + result.err, IsEmpty());
  EXPECT_TRUE(fs::exists(path("a.engram")));  // the rawlog's name
  EXPECT_TRUE(jsonOf(path("m.json"))["false_closures"].is_null());
  EXPECT_TRUE(jsonOf(path("m.json"))["ate_m"].is_null());
}

TEST_F(SlamTest, ReportHasAllItsFiles) {
  writeRawlog(path("a.rawlog"), firstFrames(8));
  const RunResult result =
      slam({config(), "--rawlog", path("a.rawlog"), "--report", path("deep/report"), "-q"});
  ASSERT_EQ(result.code, kOk) << result.err;
  for (const char* name : {"images.jsonl", "index.html", "map.3Dscene", "map.graph", "trajectory.tum"})
    EXPECT_GT(fs::file_size(path(std::string("deep/report/") + name)), 100u) << name;
  const std::string lines = bytesOf(path("deep/report/images.jsonl"));
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 8);
}

TEST_F(SlamTest, ExtendGoesOnWithTheMap) {
  const std::string map = mapCopy();
  const RunResult result = slam({config(), "--rawlog", rawlog(2), "--map", map, "--extend", "--truth",
                                 truth(2), "--json", path("m.json")});
  ASSERT_EQ(result.code, kOk) << result.err;
  EXPECT_GE(jsonOf(path("m.json"))["recognised"], 38 * 7 / 10);
  EXPECT_LE(jsonOf(path("m.json"))["new_places"], 2);
  EXPECT_EQ(soundImages(map), 76u);
}

TEST_F(SlamTest, ExistingMapIsNotTouchedUnasked) {
  const std::string map = mapCopy(), before = bytesOf(map);
  EXPECT_THAT(refusal({config(), "--rawlog", rawlog(1), "--map", map}),
              AllOf(HasSubstr(map), HasSubstr("--overwrite"), HasSubstr("--extend")));
  EXPECT_TRUE(bytesOf(map) == before);
  writeBytes(path("letter.engram"), "dear mother");
  EXPECT_THAT(refusal({config(), "--rawlog", rawlog(1), "--map", path("letter.engram"), "--overwrite", "-q"}),
              HasSubstr("letter.engram"));
  EXPECT_EQ(bytesOf(path("letter.engram")), "dear mother");
  writeRawlog(path("a.rawlog"), firstFrames(2));
  EXPECT_EQ(slam({config(), "--rawlog", path("a.rawlog"), "--map", map, "--overwrite", "-q"}).code, kOk);
  EXPECT_EQ(soundImages(map), 2u);
}

TEST_F(SlamTest, ExtendNeedsAMap) {
  EXPECT_THAT(refusal({config(), "--rawlog", rawlog(1), "--map", path("none.engram"), "--extend"}),
              AllOf(HasSubstr("none.engram"), HasSubstr("does not exist")));
}

TEST_F(SlamTest, UsageErrorsAndHelp) {
  EXPECT_EQ(slam({}).code, kUsage);
  EXPECT_EQ(slam({config(), "--colour"}).code, kUsage);
  EXPECT_EQ(slam({config(), "--rawlog"}).code, kUsage);
  EXPECT_EQ(slam({config(), "--rawlog", "x", "--truth-radius", "wide"}).code, kUsage);
  EXPECT_EQ(slam({config(), "--rawlog", "x", "--extend", "--overwrite"}).code, kUsage);
  const RunResult help = slam({"--help"});
  EXPECT_EQ(help.code, kOk);
  EXPECT_THAT(help.out, AllOf(HasSubstr("Examples"), HasSubstr("Exit codes"), HasSubstr("--extend")));
  const RunResult missing = slam({config()});
  EXPECT_EQ(missing.code, kUsage);
  EXPECT_THAT(missing.err, HasSubstr("--rawlog, --images, --video or --live is missing"));
}

TEST_F(SlamTest, BadConfigurationIsNamedWithFileLineSectionAndKey) {
  const auto message = [&](const std::string& text) {
    return refusal({configWith("c.ini", text), "--rawlog", rawlog(1), "--map", path("m.engram")});
  };
  EXPECT_THAT(message("[place]\nspacin = 1\n"),
              AllOf(HasSubstr("c.ini:4"), HasSubstr("place"), HasSubstr("spacin"), HasSubstr("spacing")));
  EXPECT_THAT(message("[place]\nspacing = one\n"),
              AllOf(HasSubstr("c.ini:4"), HasSubstr("spacing"), HasSubstr("one")));
  EXPECT_THAT(message("[place]\nspacing = 1 m\n"), AllOf(HasSubstr("c.ini:4"), HasSubstr("spacing")));
  EXPECT_THAT(message("[place]\nspacing = -1\n"),
              AllOf(HasSubstr("c.ini:4"), HasSubstr("spacing"), HasSubstr("0.05")));
  EXPECT_THAT(message("[place]\nspacing = nan\n"), AllOf(HasSubstr("c.ini:4"), HasSubstr("spacing")));
  EXPECT_THAT(message("[plaice]\nspacing = 1\n"), AllOf(HasSubstr("plaice"), HasSubstr("place")));
  EXPECT_THAT(message("[extractor]\nextractor = surff\n"), AllOf(HasSubstr("c.ini:4"), HasSubstr("surf")));
  EXPECT_THAT(message("nonsense\n"), HasSubstr("c.ini:3"));
  EXPECT_THAT(refusal({path("none.ini"), "--rawlog", rawlog(1)}), HasSubstr("none.ini"));
  EXPECT_FALSE(fs::exists(path("m.engram")));
}

TEST_F(SlamTest, BadOverridesAreNamed) {
  const auto message = [&](const std::string& assignment) {
    return refusal({config(), "--rawlog", rawlog(1), "--map", path("m.engram"), "--set", assignment});
  };
  EXPECT_THAT(message("place.spacin=1"),
              AllOf(HasSubstr("--set"), HasSubstr("spacin"), HasSubstr("spacing")));
  EXPECT_THAT(message("place.spacing=far"), AllOf(HasSubstr("--set"), HasSubstr("far")));
  EXPECT_THAT(message("place.spacing=1e9"), AllOf(HasSubstr("--set"), HasSubstr("spacing")));
  EXPECT_THAT(message("spacing"), HasSubstr("spacing"));
  EXPECT_THAT(message("camera.file=" + path("none.ini")), HasSubstr("none.ini"));
}

TEST_F(SlamTest, DumpedConfigurationsCanBeReadAgain) {
  int files = 0;
  for (const auto& entry : fs::directory_iterator(ENGRAM_SOURCE_DIR "/config")) {
    if (entry.path().extension() != ".ini") continue;
    ++files;
    const RunResult once = slam({entry.path().string(), "--dump-config", "--set", "place.spacing=1.75"});
    ASSERT_EQ(once.code, kOk) << entry.path() << once.err;
    EXPECT_THAT(once.out, AllOf(HasSubstr("[place]"), HasSubstr("spacing = 1.75")));
    writeBytes(path("dumped.ini"), once.out);
    EXPECT_EQ(slam({path("dumped.ini"), "--dump-config"}).out, once.out);
    EXPECT_EQ(localize({entry.path().string(), "--dump-config", "--set", "place.spacing=1.75"}).out,
              once.out);
  }
  EXPECT_GE(files, 2);
}

TEST_F(SlamTest, MapOfAnotherCameraExtractorOrMemoryIsRefusedByName) {
  const std::string map = mapCopy(), before = bytesOf(map);
  const auto message = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{config(), "--rawlog", rawlog(2), "--map", map, "--extend", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return refusal(arguments);
  };
  for (const char* name : {"orb", "akaze", "sift"})
    EXPECT_THAT(message({"--set", std::string("extractor.extractor=") + name}),
                AllOf(HasSubstr("the extractor 'surf'"), HasSubstr(name), HasSubstr(map)));
  EXPECT_THAT(message({"--set", "memory.memory=static"}),
              AllOf(HasSubstr("the memory model 'fsh'"), HasSubstr("static")));
  std::string camera = bytesOf(ENGRAM_SOURCE_DIR "/share/cameras/omni_world.ini");
  camera.replace(camera.find("0.97"), 4, "0.98");
  writeBytes(path("other.ini"), camera);
  EXPECT_THAT(message({"--camera", path("other.ini")}), AllOf(HasSubstr("the camera"), HasSubstr("0.98")));
  EXPECT_TRUE(bytesOf(map) == before);
}

/// what the places remember by changes only where the user says so, and the map says it, too.
TEST_F(SlamTest, OtherParametersOfMemoryWordsOrAppearanceAreRefusedByNameUnlessAccepted) {
  const std::string map = mapCopy(), before = bytesOf(map);
  const std::vector<std::string> extend{config(), "--rawlog", rawlog(2), "--map", map, "--extend", "-q"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), extend.begin(), extend.end());
    return more;
  };
  EXPECT_THAT(refusal(with({"--set", "fsh.prune_view=3", "--set", "fsh.ltm_threshold=0.5"})),
              AllOf(HasSubstr("[fsh] ltm_threshold = 0.5 (was 0.7), [fsh] prune_view = 3 (was 4)"),
                    HasSubstr("--accept-parameters")));
  EXPECT_THAT(refusal(with({"--set", "memory.update_policy=per_pass"})),
              HasSubstr("[memory] update_policy = per_pass (was per_image)"));
  EXPECT_TRUE(bytesOf(map) == before);
  // What a run does with its images may differ from drive to drive.
  EXPECT_EQ(slam(with({"--set", "select.min_distance=0.6", "--to", "4"})).code, kOk);
  ASSERT_EQ(slam(with({"--set", "fsh.prune_view=3", "--accept-parameters", "--from", "4", "--to", "8"})).code,
            kOk);
  const auto drives = store::MapFile::open(map, store::Access::kReadOnly).drives();
  EXPECT_THAT(drives.back().source, HasSubstr("with [fsh] prune_view = 3 (was 4)"));
  EXPECT_THAT(drives[drives.size() - 2].source, ::testing::Not(HasSubstr("(was")));
}

TEST_F(SlamTest, UnreadableRawlogsAreRefused) {
  const auto message = [&](const std::string& name) {
    return refusal({config(), "--rawlog", path(name), "--map", path("m.engram"), "-q"});
  };
  EXPECT_THAT(message("none.rawlog"), AllOf(HasSubstr("none.rawlog"), HasSubstr("no such file")));
  writeBytes(path("empty.rawlog"), "");
  EXPECT_THAT(message("empty.rawlog"), AllOf(HasSubstr("empty.rawlog"), HasSubstr("empty")));
  writeBytes(path("text.rawlog"), std::string(3000, 'x'));
  EXPECT_THAT(message("text.rawlog"), HasSubstr("text.rawlog"));
  raw::writeWithMrpt(path("blind.rawlog"),
                     {raw::laserObject(raw::kStart), raw::odometryObject(raw::kStart, 0, 0, 0)}, true);
  EXPECT_THAT(message("blind.rawlog"), AllOf(HasSubstr("blind.rawlog"), HasSubstr("no images")));
  EXPECT_FALSE(fs::exists(path("m.engram")));
}

TEST_F(SlamTest, TruncatedRawlogIsUsedUpToTheDamage) {
  writeRawlog(path("a.rawlog"), firstFrames(10));
  fs::resize_file(path("a.rawlog"), fs::file_size(path("a.rawlog")) * 6 / 10);
  const RunResult result = slam({config(), "--rawlog", path("a.rawlog"), "--json", path("m.json"), "-q"});
  EXPECT_EQ(result.code, kPartial);
  EXPECT_THAT(result.err, AllOf(HasSubstr("a.rawlog"), HasSubstr("truncated"), HasSubstr("images read")));
  const std::size_t images = jsonOf(path("m.json"))["images"];
  EXPECT_GE(images, 4u);
  EXPECT_LE(images, 6u);
  EXPECT_EQ(soundImages(path("a.engram")), images);
}

TEST_F(SlamTest, FlippedBitsLoseNoMoreThanWhatFollows) {
  writeRawlog(path("good.rawlog"), firstFrames(6));
  const std::string good = bytesOf(path("good.rawlog"));
  for (const double share : {0.3, 0.55, 0.8}) {
    std::string bad = good;
    bad[static_cast<std::size_t>(share * static_cast<double>(bad.size()))] ^= 0x10;
    writeBytes(path("bad.rawlog"), bad);
    const RunResult result = slam({config(), "--rawlog", path("bad.rawlog"), "--overwrite", "-q"});
    EXPECT_EQ(result.code, kPartial) << share;
    EXPECT_THAT(result.err, HasSubstr("bad.rawlog")) << share;
    EXPECT_GE(soundImages(path("bad.engram")), static_cast<std::size_t>(6 * share) - 1) << share;
  }
}

/// Images and odometry as given, with MRPT's own writer.
TEST_F(SlamTest, OddRawlogsAreMappedWithANotice) {
  const auto frames = firstFrames(6);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  raw::Objects objects;
  const auto add = [&](int i, const cv::Mat& image, double x, double stamp) {
    objects.push_back(raw::odometryObject(stamp, x, 0, 0));
    objects.push_back(raw::imageObject(stamp, image));
    EXPECT_GE(i, 0);
  };
  const cv::Mat black(480, 640, CV_8UC3, cv::Scalar::all(0));
  add(0, frames[0].image, 0, raw::kStart);
  add(1, frames[1].image, 0.5, raw::kStart + 1);
  add(2, frames[2].image, nan, raw::kStart + 2);                            // odometry is not a number
  add(3, frames[2].image, 1.0, raw::kStart + 2);                            // the stamp repeats
  add(4, black, 1.25, raw::kStart + 3);                                     // nothing to see
  add(5, frames[3].image(cv::Rect(0, 0, 320, 240)), 1.5, raw::kStart + 4);  // another size
  add(6, frames[4].image, 2.0, raw::kStart + 5);
  objects.push_back(raw::imageObject(raw::kStart + 5.5, frames[0].image, "REAR"));  // another camera
  raw::writeWithMrpt(path("odd.rawlog"), objects, true);
  const RunResult result = slam({config(), "--rawlog", path("odd.rawlog"), "--json", path("m.json"), "-q"});
  EXPECT_EQ(result.code, kOk) << result.err;  // nothing of the rawlog was lost
  EXPECT_THAT(result.err, AllOf(HasSubstr("odd.rawlog"), HasSubstr("not a number"), HasSubstr("repeats"),
                                HasSubstr("REAR")));
  const auto j = jsonOf(path("m.json"));
  EXPECT_EQ(j["images"], 6);
  EXPECT_EQ(j["unusable"], 2);
  EXPECT_EQ(soundImages(path("odd.engram")), 6u);
}

TEST_F(SlamTest, FirstImageMustFitTheCamera) {
  raw::writeWithMrpt(path("a.rawlog"), {raw::imageObject(raw::kStart, raw::picture(1, {320, 200}))}, true);
  EXPECT_THAT(refusal({config(), "--rawlog", path("a.rawlog"), "-q"}),
              AllOf(HasSubstr("320x200"), HasSubstr("640x480"), HasSubstr("--camera FILE")));
  EXPECT_FALSE(fs::exists(path("a.engram")));
}

TEST_F(SlamTest, EveryExtractorMapsAndLocalises) {
  writeRawlog(path("a.rawlog"), firstFrames(5));
  for (const char* name : {"akaze", "orb", "sift"}) {
    const std::string set = std::string("extractor.extractor=") + name,
                      map = path(std::string(name) + ".engram");
    const RunResult made = slam({config(), "--rawlog", path("a.rawlog"), "--map", map, "--set", set, "-q"});
    ASSERT_EQ(made.code, kOk) << name << made.err;
    const RunResult found = localize(
        {config(), "--rawlog", path("a.rawlog"), "--map", map, "--set", set, "--json", path("l.json"), "-q"});
    ASSERT_EQ(found.code, kOk) << name << found.err;
    EXPECT_GE(jsonOf(path("l.json"))["accepted"], 3) << name;
  }
}

TEST_F(SlamTest, FoldersThatCannotBeWrittenAreNamed) {
  writeRawlog(path("a.rawlog"), firstFrames(2));
  writeBytes(path("file"), "");
  const auto message = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{config(), "--rawlog", path("a.rawlog"), "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return refusal(arguments);
  };
  EXPECT_THAT(message({"--map", path("file/m.engram")}), HasSubstr(path("file/m.engram")));
  EXPECT_THAT(message({"--map", path("none/m.engram")}), HasSubstr(path("none/m.engram")));
  EXPECT_THAT(message({"--map", "/proc/m.engram"}), HasSubstr("/proc/m.engram"));
  EXPECT_THAT(message({"--map", path("m.engram"), "--report", path("file/report")}),
              HasSubstr(path("file/report")));
  EXPECT_FALSE(fs::exists(path("m.engram")));  // found out before the work
  EXPECT_THAT(message({"--map", path("n.engram"), "--json", path("none/m.json")}),
              HasSubstr(path("none/m.json")));
  EXPECT_THAT(message({"--map", path("o.engram"), "--truth", path("none.tum")}), HasSubstr("none.tum"));
}

/// A limit on the size of files stands for a full disk.
TEST_F(SlamTest, FullDiskKeepsWhatWasCommitted) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const std::string all = rawlog(1);
  const rlimit limit{700000, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &limit);
  const RunResult result = slam({config(), "--rawlog", all, "--map", path("m.engram"), "-q"});
  setrlimit(RLIMIT_FSIZE, &old);
  EXPECT_EQ(result.code, kError);
  EXPECT_THAT(result.err, AllOf(HasSubstr("m.engram"), HasSubstr("disk")));
  const std::size_t images = soundImages(path("m.engram"));
  EXPECT_GE(images, 2u);
  EXPECT_LT(images, 38u);
}

TEST_F(SlamTest, CtrlCKeepsTheImagesSoFar) {
  std::vector<types::Frame> frames;  // three laps without odometry: seconds of work
  for (int lap = 0; lap < 3; ++lap)
    for (auto frame : firstFrames(38)) {
      frame.stamp += 1000 * lap;
      frame.T_odom_robot.reset();
      frames.push_back(frame);
    }
  writeRawlog(path("long.rawlog"), frames);
  const std::string program = ENGRAM_BIN_DIR "/engram-slam", log = path("long.rawlog"),
                    map = path("m.engram"), json = path("m.json"), errors = path("err.txt"), ini = config();
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const int err = open(errors.c_str(), O_CREAT | O_WRONLY, 0600);
    dup2(err, 2);
    dup2(err, 1);
    execl(program.c_str(), program.c_str(), ini.c_str(), "--rawlog", log.c_str(), "--map", map.c_str(),
          "--json", json.c_str(), "--set", "extractor.max_features=1500", static_cast<char*>(nullptr));
    _exit(127);
  }
  const auto committed = [&] {
    std::error_code none;
    const auto size = fs::file_size(map + "-wal", none);
    return !none && size > 300000;
  };
  int status = 0;
  for (int i = 0; i < 10000 && !committed(); ++i) {
    ASSERT_EQ(waitpid(child, &status, WNOHANG), 0) << bytesOf(errors);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  kill(child, SIGINT);
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), kPartial) << bytesOf(errors);
  EXPECT_THAT(bytesOf(errors), HasSubstr("interrupted; the map holds every image up to here"));
  const std::size_t images = soundImages(map);
  EXPECT_GE(images, 1u);
  EXPECT_LT(images, frames.size());
  EXPECT_EQ(jsonOf(json)["images"], images);
}

}  // namespace
}  // namespace engram::apps
