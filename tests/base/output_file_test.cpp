// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/atomic_file.h"
#include "engram/base/line_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <thread>
#include <unistd.h>

namespace {

/// What reached the system, in its order: "sync NAME", "rename NAME".
std::vector<std::string> calls;

std::string nameOf(int descriptor) {
  return std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(descriptor)).filename().string();
}

}  // namespace

// In place of those of the C library.
extern "C" int fsync(int descriptor) {
  calls.push_back("sync " + nameOf(descriptor));
  return static_cast<int>(::syscall(SYS_fsync, descriptor));
}
extern "C" int rename(const char* from, const char* to) noexcept {
  calls.push_back("rename " + std::filesystem::path(from).filename().string());
  return static_cast<int>(::syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

namespace engram::base {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

std::string bytesOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

mode_t modeOf(const std::string& path) {
  struct stat status {};
  EXPECT_EQ(::lstat(path.c_str(), &status), 0) << path;
  return status.st_mode;
}

/// The message of the base::Error that an action throws; empty when it throws none.
template <class Action>
std::string errorOf(const Action& action) {
  try {
    action();
  } catch (const Error& e) {
    return e.what();
  }
  return {};
}

class OutputFileTest : public ::testing::Test {
 protected:
  OutputFileTest() {
    std::string name = (fs::temp_directory_path() / "engram_output_XXXXXX").string();
    folder_ = mkdtemp(name.data());
    calls.clear();
  }
  ~OutputFileTest() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string put(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder_)) all.insert(entry.path().filename().string());
    return all;
  }

  fs::path folder_;
};

TEST_F(OutputFileTest, AFileIsMadeAndReplacedWhole) {
  writeText(path("a.json"), "one");
  EXPECT_EQ(bytesOf(path("a.json")), "one");
  writeText(path("a.json"), "two", true);
  EXPECT_EQ(bytesOf(path("a.json")), "two");
  EXPECT_THAT(errorOf([&] { writeText(path("a.json"), "three"); }), HasSubstr("exists already"));
  EXPECT_EQ(bytesOf(path("a.json")), "two");
  EXPECT_THAT(names(), ElementsAre("a.json"));
}

TEST_F(OutputFileTest, AWriterThatFailsLeavesTheEarlierFile) {
  put("a.png", "old");
  EXPECT_THAT(errorOf([&] {
                writeAtomically(path("a.png"), true, [](const std::string& name) {
                  std::ofstream(name) << "half";
                  throw Error("no ink");
                });
              }),
              HasSubstr("a.png': no ink"));
  EXPECT_EQ(bytesOf(path("a.png")), "old");
  EXPECT_THAT(names(), ElementsAre("a.png"));
}

// A crash of the computer after the rename must not find an empty file under the name.
TEST_F(OutputFileTest, TheBytesAreOnTheDiskBeforeTheName) {
  writeText(path("a.json"), "bytes", true);
  ASSERT_EQ(calls.size(), 3u);
  EXPECT_THAT(calls[0], StartsWith("sync .partial-"));
  EXPECT_EQ(calls[1], "rename " + calls[0].substr(5));
  EXPECT_EQ(calls[2], "sync " + folder_.filename().string());
  calls.clear();
  writeText(path("b.json"), "bytes", true, Sync::kLater);
  EXPECT_EQ(calls.size(), 1u);
}

TEST_F(OutputFileTest, TheTemporaryNameCannotBeGuessedAndKeepsTheEnding) {
  std::set<std::string> seen;
  for (int i = 0; i < 20; ++i)
    writeAtomically(path("map.3Dscene"), true, [&](const std::string& name) { seen.insert(name); });
  EXPECT_EQ(seen.size(), 20u);
  for (const auto& name : seen) EXPECT_THAT(name, EndsWith("map.3Dscene"));
  const std::string longest = std::string(251, 'x') + ".png";
  writeAtomically(path(longest), true, [](const std::string& name) { EXPECT_THAT(name, EndsWith(".png")); });
  EXPECT_TRUE(fs::exists(path(longest)));
}

// Where the temporary file once lay.
TEST_F(OutputFileTest, APlantedLinkIsNotFollowed) {
  put("victim", "mine");
  fs::create_symlink(path("victim"), path(".partial-a.json"));
  writeText(path("a.json"), "theirs");
  EXPECT_EQ(bytesOf(path("victim")), "mine");
  EXPECT_EQ(bytesOf(path("a.json")), "theirs");
}

TEST_F(OutputFileTest, ALinkOfSomebodyElseInAFolderOfAllIsRefused) {
  fs::create_directory(path("all"));
  ASSERT_EQ(::chmod(path("all").c_str(), 01777), 0);
  put("victim", "mine");
  fs::create_symlink(path("victim"), path("all/out.json"));
  writeText(path("all/out.json"), "by my own link", true);
  EXPECT_EQ(bytesOf(path("victim")), "by my own link");
  if (::geteuid() != 0) return;  // only root can make a link of somebody else
  ASSERT_EQ(::lchown(path("all/out.json").c_str(), 12345, 12345), 0);
  EXPECT_FALSE(errorOf([&] { writeText(path("all/out.json"), "theirs", true); }).empty());
  EXPECT_FALSE(errorOf([&] { requireWritable(path("all/out.json")); }).empty());
  EXPECT_EQ(bytesOf(path("victim")), "by my own link");
}

TEST_F(OutputFileTest, ALinkStaysAndWhatItNamesIsReplaced) {
  fs::create_directory(path("far"));
  put("far/a.json", "old");
  fs::create_symlink("far/a.json", path("one"));
  fs::create_symlink("one", path("two"));
  writeText(path("two"), "new", true);
  EXPECT_TRUE(fs::is_symlink(path("two")));
  EXPECT_TRUE(fs::is_symlink(path("one")));
  EXPECT_EQ(bytesOf(path("far/a.json")), "new");
  fs::create_symlink("far/none.json", path("open"));
  writeText(path("open"), "made");
  EXPECT_TRUE(fs::is_symlink(path("open")));
  EXPECT_EQ(bytesOf(path("far/none.json")), "made");
  fs::create_symlink("round", path("round"));
  EXPECT_THAT(errorOf([&] { writeText(path("round"), "x"); }), HasSubstr("levels of symbolic links"));
}

TEST_F(OutputFileTest, APipeIsWrittenThrough) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  std::string got;
  const auto whileRead = [&](const auto& write) {
    std::thread reader([&] { got = bytesOf(path("pipe")); });
    write();
    reader.join();
    EXPECT_TRUE(S_ISFIFO(modeOf(path("pipe"))));
  };
  whileRead([&] { writeText(path("pipe"), "text"); });
  EXPECT_EQ(got, "text");
  whileRead([&] {
    writeAtomically(path("pipe"), false, [](const std::string& name) { std::ofstream(name) << "named"; });
  });
  EXPECT_EQ(got, "named");
  whileRead([&] {
    LineFile lines(path("pipe"));
    lines.add("a");
    lines.add("b");
  });
  EXPECT_EQ(got, "a\nb\n");
  EXPECT_THAT(names(), ElementsAre("pipe"));
}

TEST_F(OutputFileTest, ADeviceIsWrittenThroughAndStays) {
  fs::create_symlink("/dev/null", path("null"));
  writeText(path("null"), "gone", true);
  EXPECT_TRUE(fs::is_symlink(path("null")));
  EXPECT_TRUE(S_ISCHR(modeOf("/dev/null")));
  EXPECT_THAT(errorOf([] { writeText("/dev/full", "x", true); }),
              HasSubstr("'/dev/full': No space left on device"));
  EXPECT_TRUE(S_ISCHR(modeOf("/dev/full")));
}

TEST_F(OutputFileTest, WhatTakesNoBytesIsRefused) {
  EXPECT_THAT(errorOf([&] { writeText(folder_.string(), "x", true); }), HasSubstr("it is a folder"));
  EXPECT_THAT(errorOf([&] { writeText(path("none/a"), "x", true); }), HasSubstr("does not exist"));
  EXPECT_THAT(errorOf([] { writeText("", "x", true); }), HasSubstr("needs a file name"));
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path("s").c_str(), sizeof address.sun_path - 1);
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_THAT(errorOf([&] { writeText(path("s"), "x", true); }), HasSubstr("it is a socket"));
  ::close(socket);
  EXPECT_TRUE(S_ISSOCK(modeOf(path("s"))));
}

TEST_F(OutputFileTest, AFileBecomesNoMoreOpenThanItWas) {
  const mode_t old = ::umask(022);
  writeText(path("new"), "x");
  EXPECT_EQ(modeOf(path("new")) & 0777, 0644u);
  ::chmod(path("new").c_str(), 0600);
  writeText(path("new"), "y", true);
  EXPECT_EQ(modeOf(path("new")) & 0777, 0600u);
  ::umask(old);
}

TEST_F(OutputFileTest, AFileThatComesUpMeanwhileIsNotReplaced) {
  EXPECT_THAT(errorOf([&] {
                writeAtomically(path("a"), false, [&](const std::string& name) {
                  std::ofstream(name) << "mine";
                  put("a", "theirs");
                });
              }),
              HasSubstr("File exists"));
  EXPECT_EQ(bytesOf(path("a")), "theirs");
  EXPECT_THAT(names(), ElementsAre("a"));
  const auto pipeComes = [&] {
    writeAtomically(path("p"), true, [&](const std::string&) { ::mkfifo(path("p").c_str(), 0600); });
  };
  EXPECT_THAT(errorOf(pipeComes), HasSubstr("no longer a regular file"));
  EXPECT_TRUE(S_ISFIFO(modeOf(path("p"))));
}

TEST_F(OutputFileTest, AFullDiskLeavesTheEarlierFileWhole) {
  put("a.csv", "old");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const rlimit limit{5000, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &limit);
  const std::string message = errorOf([&] { writeText(path("a.csv"), std::string(20000, 'x'), true); });
  setrlimit(RLIMIT_FSIZE, &old);
  EXPECT_THAT(message, HasSubstr("File too large; free some space"));
  EXPECT_EQ(bytesOf(path("a.csv")), "old");
  EXPECT_THAT(names(), ElementsAre("a.csv"));
}

TEST_F(OutputFileTest, WhetherItCanBeWrittenIsToldBeforehandAndChangesNothing) {
  put("a", "old");
  EXPECT_NO_THROW(requireWritable(""));
  EXPECT_NO_THROW(requireWritable(path("a")));
  EXPECT_NO_THROW(requireWritable(path("new"), false));
  EXPECT_NO_THROW(requireWritable("/dev/null", false));
  EXPECT_THAT(errorOf([&] { requireWritable(path("a"), false); }), HasSubstr("exists already"));
  EXPECT_THAT(errorOf([] { requireWritable("."); }), HasSubstr("'.': it is a folder"));
  EXPECT_THAT(errorOf([&] { requireWritable(path("none/b")); }), HasSubstr("does not exist"));
  EXPECT_THAT(errorOf([&] { requireWritable(path("a/b")); }), HasSubstr("Not a directory"));
  EXPECT_THAT(errorOf([] { requireWritable("/proc/engram.json"); }), HasSubstr("cannot write"));
  EXPECT_THAT(errorOf([&] { requireWritable(path(std::string(300, 'x'))); }), HasSubstr("too long"));
  EXPECT_THAT(errorOf([&] { requireWritableFolder(path("none")); }), HasSubstr("does not exist"));
  EXPECT_NO_THROW(requireWritableFolder(folder_.string()));
  EXPECT_EQ(bytesOf(path("a")), "old");
  EXPECT_THAT(names(), ElementsAre("a"));
}

TEST_F(OutputFileTest, LinesGoToNoPlantedFileAndThroughLinks) {
  put("old", "old");
  fs::create_symlink("old", path("link"));
  LineFile lines(path("link"));
  lines.add("one");
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(bytesOf(path("old")), "one\n");
}

/// Standard output is a file of the test while this lives.
class StandardOutputAt {
 public:
  explicit StandardOutputAt(int descriptor) : saved_(::dup(STDOUT_FILENO)) {
    ::dup2(descriptor, STDOUT_FILENO);
    ::close(descriptor);
  }
  ~StandardOutputAt() {
    ::dup2(saved_, STDOUT_FILENO);
    ::close(saved_);
  }

 private:
  int saved_;
};

TEST_F(OutputFileTest, AMinusIsStandardOutput) {
  {
    const StandardOutputAt file(::open(path("out").c_str(), O_WRONLY | O_CREAT, 0600));
    requireWritable("-");
    writeText("-", "text\n");
    writeAtomically("-", false, [](const std::string& name) { std::ofstream(name) << "named\n"; });
    LineFile("-").add("line");
    writeText(path("out"), "by its name\n", true);  // replacing it would lose what is there
  }
  EXPECT_EQ(bytesOf(path("out")), "text\nnamed\nline\nby its name\n");
  EXPECT_THAT(names(), ElementsAre("out"));
}

TEST_F(OutputFileTest, AStandardOutputThatTakesNothingIsAnError) {
  std::signal(SIGPIPE, SIG_IGN);
  {
    const StandardOutputAt full(::open("/dev/full", O_WRONLY));
    EXPECT_THAT(errorOf([] { writeText("-", "x"); }), HasSubstr("No space left"));
  }
  {
    const StandardOutputAt closed(::open("/dev/null", O_RDONLY));
    EXPECT_THAT(errorOf([] { requireWritable("-"); }), HasSubstr("closed"));
  }
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ::close(ends[0]);
  const StandardOutputAt pipe(ends[1]);
  EXPECT_THROW(writeText("-", "x"), ClosedPipe);
  EXPECT_THROW(LineFile("-").add("x"), ClosedPipe);
}

}  // namespace
}  // namespace engram::base
