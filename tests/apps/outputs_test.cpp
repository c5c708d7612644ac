// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What the programs do when an output cannot be written, in processes of their own.
#include "engram/sources/rawlog_source.h"
#include "program_process.h"
#include "run_fixture.h"

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sys/resource.h>
#include <sys/stat.h>
#include <thread>

namespace engram::apps {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ProgramProcess;
using Words = std::vector<std::string>;

class OutputsTest : public RunTest {
 protected:
  void SetUp() override {
    RunTest::SetUp();
    fs::create_directory(path("images"));
    for (const int i : {0, 1, 2})
      cv::imwrite(path("images/" + std::to_string(i) + ".png"), cv::Mat(48, 64, CV_8U, cv::Scalar(20 * i)));
  }
  Words pack(const std::string& out) const {
    return {"engram-rawlog", "pack", "--images", path("images"), "--out", out};
  }

  /// Runs a program with standard output at `to`, a path or a descriptor; its messages go to err_.
  int run(const Words& command, int out) {
    const int err = ::open(path("err").c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    const int status = ProgramProcess{command, out, err}.run();
    ::close(err);
    err_ = bytesOf(path("err"));
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  int run(const Words& command, const std::string& to) {
    const int out = ::open(to.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    const int code = run(command, out);
    ::close(out);
    out_ = to == path("out") ? bytesOf(to) : "";
    return code;
  }
  int run(const Words& command) { return run(command, path("out")); }

  std::string out_, err_;
};

TEST_F(OutputsTest, AFullStandardOutputIsAnError) {
  const std::string map = firstMap();
  const Words commands[] = {{"engram-map", "dump", map},
                            {"engram-map", "info", map},
                            {"engram-map", "info", map, "--json", "-"},
                            {"engram-map", "check", map},
                            {"engram-map", "export", map, "--format", "tum", "--out", "-"},
                            {"engram-rawlog", "info", rawlog(1), "-q"},
                            {"engram-slam", config(), "--dump-config"},
                            {"engram-localize", config(), "--dump-config"},
                            {"engram-eval", "memory", "--dump-config"},
                            {"engram-world", "plan"},
                            {"engram-slam", "--help"},
                            {"engram-capture", "--help"}};
  for (const auto& command : commands) {
    const std::string name = ::testing::PrintToString(command);
    EXPECT_EQ(run(command, "/dev/full"), kError) << name;
    EXPECT_THAT(err_, HasSubstr("No space left on device")) << name;
    EXPECT_EQ(run(command, ProgramProcess::kClosed), kError) << name;
    EXPECT_THAT(err_, HasSubstr("tandard output")) << name;
    EXPECT_EQ(run(command), kOk) << name << err_;
    EXPECT_GT(out_.size(), 10u) << name;
  }
}

// As other tools before `| head`: no message, and the status of SIGPIPE.
TEST_F(OutputsTest, AReaderThatHasGoneEndsAProgramQuietly) {
  for (const Words& command : {Words{"engram-map", "dump", firstMap()},
                               Words{"engram-map", "info", firstMap(), "--json", "-", "-q"}, pack("-")}) {
    int ends[2];
    ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
    ::close(ends[0]);
    EXPECT_EQ(run(command, ends[1]), 128 + SIGPIPE) << command[1];
    EXPECT_THAT(err_, IsEmpty());
    ::close(ends[1]);
  }
}

TEST_F(OutputsTest, AMinusGivesStandardOutputToProgramsAlone) {
  EXPECT_EQ(run({"engram-map", "info", firstMap(), "--json", "-"}), kOk);
  EXPECT_GT(nlohmann::json::parse(out_).at("places"), 3);
  EXPECT_THAT(err_, HasSubstr("places"));
  EXPECT_EQ(run({"engram-localize", config(), "--map", firstMap(), "--rawlog", rawlog(2), "--out", "-"}),
            kOk);
  EXPECT_EQ(std::count(out_.begin(), out_.end(), '\n'), 39);  // head and images
  EXPECT_THAT(err_, HasSubstr("38 images"));
  EXPECT_EQ(run(pack("-")), kOk);
  auto source = sources::openRawlog(path("out"));
  int images = 0;
  while (source->next()) ++images;
  EXPECT_EQ(images, 3);
  EXPECT_EQ(source->problem(), "");
  EXPECT_EQ(run({"engram-localize", config(), "--map", firstMap(), "--rawlog", rawlog(2), "--out", "-",
                 "--json", "-"}),
            kUsage);
  EXPECT_FALSE(fs::exists("-"));
}

TEST_F(OutputsTest, APipeGetsAWholeRawlogWithoutStandardDescriptors) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  const pid_t child = ProgramProcess{pack(path("pipe"))}.start();  // without output and error
  const std::string bytes = bytesOf(path("pipe"));
  int status = -1;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), kError);  // its summary had no place
  writeBytes(path("a.rawlog"), bytes);
  auto source = sources::openRawlog(path("a.rawlog"));
  while (source->next()) {
  }
  EXPECT_EQ(source->problem(), "");
}

TEST_F(OutputsTest, ADeviceOrLinkAtTheNameStays) {
  writeBytes(path("target.json"), "old");
  fs::create_symlink("target.json", path("link.json"));
  fs::create_symlink("/dev/null", path("null"));
  for (const char* json : {"link.json", "null"})
    EXPECT_EQ(run({"engram-map", "info", firstMap(), "--json", path(json)}), kOk) << err_;
  EXPECT_TRUE(fs::is_symlink(path("link.json")));
  EXPECT_TRUE(jsonOf(path("target.json")).contains("places"));
  EXPECT_TRUE(fs::is_symlink(path("null")));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_EQ(run(pack("/dev/null")), kOk) << err_;
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_EQ(run(pack("/dev/full")), kError);
  EXPECT_THAT(err_, HasSubstr("No space left"));
}

// Nothing of the work is done, so that nothing is there afterwards.
TEST_F(OutputsTest, AnOutputThatCannotBeWrittenIsRefusedAtTheStart) {
  const std::string made = path("made");
  const Words commands[] = {
      {"engram-slam", config(), "--rawlog", rawlog(1), "--map", made},
      {"engram-localize", config(), "--map", firstMap(), "--rawlog", rawlog(2), "--out", made},
      {"engram-map", "info", firstMap()},
      pack(made),
      {"engram-rawlog", "info", rawlog(1)},
      {"engram-rawlog", "unpack", rawlog(1), "--out", made},
      {"engram-rawlog", "calibrate", "--images", path("images"), "--board", "9x6", "--square", "1", "--out",
       made},
      {"engram-capture", "check", rawlog(1)},
      {"engram-world", "make", "--preset", "tiny", "--out", made},
      {"engram-eval", "memory", "--quick", "--out", made},
      {"engram-eval", "odometry", "--rawlog", rawlog(1), "--out", made}};
  for (Words command : commands) {
    for (const std::string& json :
         {std::string("."), path("none/x.json"), "/proc/" + std::string("x.json")}) {
      Words with = command;
      with.insert(with.end(), {"--json", json});
      EXPECT_EQ(run(with), kError) << ::testing::PrintToString(with);
      EXPECT_THAT(err_, HasSubstr("cannot write '" + json + "'")) << ::testing::PrintToString(with);
      EXPECT_THAT(out_, IsEmpty());
      EXPECT_FALSE(fs::exists(made)) << ::testing::PrintToString(with);
    }
  }
}

TEST_F(OutputsTest, AReportThatCannotBeWrittenIsRefusedAtTheStart) {
  const std::string made = path("made.engram");
  fs::create_directories(path("report/index.html"));
  writeBytes(path("file"), "mine");
  for (const char* report : {"report", "file", "file/deeper"}) {
    EXPECT_EQ(run({"engram-slam", config(), "--rawlog", rawlog(1), "--map", made, "--report", path(report)}),
              kError);
    EXPECT_THAT(err_, HasSubstr(path(report))) << report;
    EXPECT_FALSE(fs::exists(made)) << report;
  }
  EXPECT_EQ(bytesOf(path("file")), "mine");
  EXPECT_EQ(run({"engram-map", "export", firstMap(), "--format", "html", "--out", path("file")}), kError);
  EXPECT_THAT(err_, HasSubstr("exists already"));
}

TEST_F(OutputsTest, AFullDiskInTheMiddleOfAFileLeavesTheEarlierOne) {
  const std::string map = firstMap();
  writeBytes(path("page.html"), "earlier");
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const rlimit small{256, old.rlim_max};
  for (const char* format : {"html", "3dscene"}) {
    std::signal(SIGXFSZ, SIG_DFL);  // what a shell hands on
    setrlimit(RLIMIT_FSIZE, &small);
    const int code =
        run({"engram-map", "export", map, "--format", format, "--overwrite", "--out", path("page.html")});
    setrlimit(RLIMIT_FSIZE, &old);
    EXPECT_EQ(code, kError) << format;
    EXPECT_THAT(err_, HasSubstr("page.html")) << format;
    EXPECT_EQ(bytesOf(path("page.html")), "earlier") << format;
  }
  for (const auto& entry : fs::directory_iterator(folder_))
    EXPECT_THAT(entry.path().filename().string(), ::testing::Not(HasSubstr("partial")));
}

TEST_F(OutputsTest, WhatIsMissingOnTheCommandLineIsAUsageError) {
  for (const Words& command :
       {Words{"engram-slam", config()},
        {"engram-localize", config()},
        {"engram-slam", config(), "--rawlog", rawlog(1), "--record", path("r")},
        {"engram-world", "make"},
        {"engram-world", "render"},
        {"engram-eval", "memory"},
        {"engram-eval", "odometry"},
        {"engram-eval", "images"},
        {"engram-rawlog", "calibrate", "--board", "9x6", "--square", "1", "--out", path("c")}}) {
    EXPECT_EQ(run(command), kUsage) << ::testing::PrintToString(command);
    EXPECT_THAT(err_, HasSubstr("--help")) << ::testing::PrintToString(command);
  }
}

// A terminal that closes sends more than one.
TEST_F(OutputsTest, AHangUpEndsARunAsCtrlCDoes) {
  writeRawlog(path("a.rawlog"), firstFrames(30));
  const int null = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  const pid_t child =
      ProgramProcess{
          {"engram-slam", config(), "--rawlog", path("a.rawlog"), "--map", path("m.engram")}, null, null}
          .start();
  while (!fs::exists(path("m.engram")) && ::waitpid(child, nullptr, WNOHANG) == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ::kill(child, SIGHUP);
  ::kill(child, SIGHUP);
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ::close(null);
  ASSERT_TRUE(WIFEXITED(status)) << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), kPartial);
  EXPECT_GE(soundImages(path("m.engram")), 1u);
}

}  // namespace
}  // namespace engram::apps
