// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// engram-map copy and recover, and what check says of maps that lost their log.
#include "engram/store/map_file.h"
#include "map_program.h"
#include "sample_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <unistd.h>

namespace engram::apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
namespace fs = std::filesystem;

class MapCopyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/engram_copy_XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    folder_ = name;
    from_ = path("m.engram");
    to_ = path("n.engram");
    map_ = testing::ringMap(5);
    map::MapHeader header;
    header.descriptorDim = 64;
    writer_.emplace(store::MapFile::create(from_, header));
    writer_->commit(map_, map_.takeChanges());
  }
  void TearDown() override {
    writer_.reset();
    fs::remove_all(folder_);
  }
  int run(const std::vector<std::string>& arguments) {
    MapProgram program;
    out_.str("");
    err_.str("");
    return runProgram(program, arguments, out_, err_);
  }
  std::string dumpOf(const std::string& map) {
    EXPECT_EQ(run({"dump", map}), kOk) << err_.str();
    return out_.str();
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static std::string read(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void write(const std::string& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
  }

  fs::path folder_;
  std::string from_, to_;
  map::TopologicalMap map_;
  std::optional<store::MapFile> writer_;
  std::ostringstream out_, err_;
};

TEST_F(MapCopyTest, CopiesWhileAWriterHasTheMapOpen) {
  EXPECT_EQ(run({"copy", from_, to_}), kOk) << err_.str();
  EXPECT_THAT(out_.str(), HasSubstr("n.engram: written"));
  EXPECT_EQ(dumpOf(to_), dumpOf(from_));
  EXPECT_EQ(run({"check", to_}), kOk);
  EXPECT_EQ(run({"copy", from_, to_}), kError);
  EXPECT_THAT(err_.str(), HasSubstr("exists already"));
  map_.addPlace({});
  writer_->commit(map_, map_.takeChanges());
  EXPECT_EQ(run({"copy", from_, to_, "--overwrite", "-q"}), kOk);
  EXPECT_THAT(out_.str(), IsEmpty());
  EXPECT_EQ(dumpOf(to_), dumpOf(from_));
  write(path("letter"), "dear map");
  EXPECT_EQ(run({"copy", from_, path("letter"), "--overwrite"}), kError);
  EXPECT_EQ(read(path("letter")), "dear map");
}

TEST_F(MapCopyTest, CheckReportsAMapWithoutItsLog) {
  writer_.reset();  // folded
  writer_.emplace(store::MapFile::open(from_, store::Access::kReadWrite));
  map_.addPlace({});
  writer_->commit(map_, map_.takeChanges());
  fs::copy_file(from_, to_);
  EXPECT_EQ(run({"check", to_}), kPartial);
  EXPECT_THAT(out_.str(), AllOf(HasSubstr("copied without"), HasSubstr("as far as it goes")));
  EXPECT_EQ(run({"info", to_}), kOk);
  EXPECT_THAT(err_.str(), HasSubstr("last images may be missing"));
  EXPECT_EQ(run({"check", from_}), kOk) << out_.str();
}

TEST_F(MapCopyTest, RecoverSaysWhatWasLost) {
  writer_.reset();
  EXPECT_EQ(run({"recover", from_, to_}), kOk) << err_.str();
  EXPECT_THAT(out_.str(), AllOf(HasSubstr("5 places"), HasSubstr("all of it was saved")));
  EXPECT_EQ(dumpOf(to_), dumpOf(from_));
  std::string bytes = read(from_);
  bytes[bytes.find("image_3.png")] = 'X';
  write(from_, bytes);
  EXPECT_EQ(run({"check", from_}), kError);
  EXPECT_THAT(out_.str(), HasSubstr("engram-map recover"));
  EXPECT_EQ(run({"copy", from_, to_, "--overwrite"}), kError);
  EXPECT_THAT(err_.str(), HasSubstr("engram-map recover"));
  EXPECT_EQ(run({"recover", from_, to_, "--overwrite"}), kPartial) << err_.str();
  EXPECT_THAT(out_.str(), AllOf(HasSubstr("4 places"), HasSubstr("lost: 1 of 5 places: number 3")));
  EXPECT_EQ(run({"check", to_}), kOk) << out_.str();
  EXPECT_EQ(read(from_), bytes);
  write(from_, std::string(20000, 'x'));
  EXPECT_EQ(run({"recover", from_, path("o.engram")}), kError);
  EXPECT_THAT(err_.str(), HasSubstr("nothing could be recovered"));
  EXPECT_FALSE(fs::exists(path("o.engram")));
  EXPECT_EQ(run({"recover", from_}), kUsage);
}

}  // namespace
}  // namespace engram::apps
