// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "run_fixture.h"

#include "engram/sources/rawlog_writer.h"
#include "localize_program.h"
#include "slam_program.h"
#include "tiny_drive.h"

#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iterator>
#include <unistd.h>

namespace engram::apps {
namespace fs = std::filesystem;
namespace {

std::string newFolder() {
  std::string name = (fs::temp_directory_path() / "engram_run_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp");
  return name;
}

/// Made once, gone with the process.
struct Shared {
  Shared() : folder(newFolder()) {
    for (const int drive : {1, 2}) {
      const auto& frames = drive == 1 ? engram::testing::firstDrive() : engram::testing::secondDrive();
      writeRawlog(folder + "/" + std::to_string(drive) + ".rawlog", frames.frames);
      std::ofstream tum(folder + "/" + std::to_string(drive) + ".tum");
      tum << std::setprecision(17);
      for (std::size_t i = 0; i < frames.frames.size(); ++i) {
        const Eigen::Quaterniond q(frames.T_world_robot[i].linear());
        tum << frames.frames[i].stamp << ' ' << frames.T_world_robot[i].translation().transpose() << ' '
            << q.x() << ' ' << q.y() << ' ' << q.z() << ' ' << q.w() << '\n';
      }
    }
  }
  ~Shared() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
  std::string folder;
};

const std::string& shared() {
  static const Shared files;
  return files.folder;
}

}  // namespace

RunResult slam(const std::vector<std::string>& arguments) { return runAs<SlamProgram>(arguments); }
RunResult localize(const std::vector<std::string>& arguments) { return runAs<LocalizeProgram>(arguments); }

void RunTest::SetUp() { folder_ = newFolder(); }

void RunTest::TearDown() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

std::string RunTest::rawlog(int drive) { return shared() + "/" + std::to_string(drive) + ".rawlog"; }
std::string RunTest::truth(int drive) { return shared() + "/" + std::to_string(drive) + ".tum"; }

std::string RunTest::firstMap() {
  const std::string map = shared() + "/first.engram";
  if (!fs::exists(map)) {
    const RunResult made = slam({config(), "--rawlog", rawlog(1), "--map", map, "--truth", truth(1), "-q"});
    EXPECT_EQ(made.code, kOk) << made.err;
  }
  return map;
}

std::string RunTest::mapCopy() const {
  fs::copy_file(firstMap(), path("copy.engram"), fs::copy_options::overwrite_existing);
  return path("copy.engram");
}

std::string RunTest::configWith(const std::string& name, const std::string& text) const {
  std::ofstream(path(name)) << "[camera]\nfile = " ENGRAM_SOURCE_DIR "/share/cameras/omni_world.ini\n"
                            << text;
  return path(name);
}

void writeRawlog(const std::string& path, const std::vector<types::Frame>& frames) {
  sources::RawlogWriter writer(path);
  for (const auto& frame : frames) writer.add(frame);
  writer.close();
}

std::vector<types::Frame> firstFrames(std::size_t n) {
  const auto& frames = engram::testing::firstDrive().frames;
  return {frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(n)};
}

std::string bytesOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void writeBytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

nlohmann::json jsonOf(const std::string& path) { return nlohmann::json::parse(bytesOf(path)); }

std::size_t soundImages(const std::string& map) {
  const auto file = store::MapFile::open(map, store::Access::kReadOnly);
  EXPECT_EQ(file.check(), std::vector<std::string>());
  file.load().checkInvariants();
  return file.records().size();
}

}  // namespace engram::apps
