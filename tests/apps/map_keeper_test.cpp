// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "../keeper/keeper_maps.h"
#include "engram/store/map_file.h"
#include "map_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <unistd.h>

namespace engram::apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// engram-map on a map of two drives.
class MapKeeperTest : public ::testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/engram_keeper_XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    folder_ = name;
    const store::WholeMap whole = engram::testing::twoDrives(12, 3);
    store::MapFile::create(map(), whole.header).replace(whole);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  int run(const std::vector<std::string>& arguments) {
    MapProgram program;
    out_.str("");
    err_.str("");
    return runProgram(program, arguments, out_, err_);
  }
  std::string dumpOf(const std::string& path) {
    std::ostringstream text;
    store::MapFile::open(path, store::Access::kReadOnly).dump(text);
    return text.str();
  }
  static std::string bytesOf(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string map() const { return path("m.engram"); }

  std::filesystem::path folder_;
  std::ostringstream out_, err_;
};

TEST_F(MapKeeperTest, EachEditIsTriedDoneAndTakenBack) {
  const std::vector<std::vector<std::string>> edits = {
      {"reduce", map(), "--views", "9"},
      {"drives", "drop", map(), "1"},
      {"closures", "reject", map(), "11"},
      {"crop", map(), "--region", "-2,-20,20,20"},
      {"anonymise", map()},
  };
  const std::string before = dumpOf(map());
  for (std::vector<std::string> edit : edits) {
    const std::string bytes = bytesOf(map());
    edit.push_back("--dry-run");
    EXPECT_EQ(run(edit), kOk) << err_.str();
    EXPECT_THAT(out_.str(), HasSubstr("dry run"));
    EXPECT_EQ(bytesOf(map()), bytes);
    edit.back() = "--undo";
    edit.push_back(path("undo"));
    EXPECT_EQ(run(edit), kOk) << err_.str();
    EXPECT_NE(dumpOf(map()), before) << edit[0];
    EXPECT_EQ(run({"check", map()}), kOk) << out_.str();
    EXPECT_EQ(dumpOf(path("undo")), before);
    EXPECT_EQ(run({"copy", path("undo"), map(), "--overwrite"}), kOk);
    EXPECT_EQ(dumpOf(map()), before);
    std::filesystem::remove(path("undo"));
  }
}

TEST_F(MapKeeperTest, UndoCopiesAreNeverOverwritten) {
  EXPECT_EQ(run({"anonymise", map()}), kOk);
  EXPECT_EQ(run({"reduce", map(), "--views", "14"}), kOk);
  EXPECT_TRUE(std::filesystem::exists(map() + ".undo"));
  EXPECT_TRUE(std::filesystem::exists(map() + ".undo-2"));
  EXPECT_EQ(run({"reduce", map(), "--views", "12", "--undo", map() + ".undo"}), kError);
  EXPECT_THAT(err_.str(), HasSubstr("exists already"));
  EXPECT_EQ(run({"reduce", map(), "--views", "14"}), kOk);
  EXPECT_THAT(out_.str(), HasSubstr("nothing to do"));
  EXPECT_FALSE(std::filesystem::exists(map() + ".undo-3"));
}

TEST_F(MapKeeperTest, DiffTellsWhatAnEditDid) {
  EXPECT_EQ(run({"drives", "drop", map(), "1", "--undo", path("old")}), kOk);
  EXPECT_EQ(run({"diff", path("old"), path("old")}), kOk);
  EXPECT_THAT(out_.str(), HasSubstr("equal"));
  EXPECT_EQ(run({"diff", path("old"), map(), "--all", "--json", path("d.json")}), kPartial);
  EXPECT_THAT(out_.str(), HasSubstr("only A: 12 13 14 15"));
  const auto json = nlohmann::json::parse(bytesOf(path("d.json")));
  EXPECT_EQ(json["kinds"]["path points"]["only_a"].size(), 12u);
  EXPECT_EQ(json["kinds"]["places"]["equal"], 12);
}

TEST_F(MapKeeperTest, ListsAndUsage) {
  EXPECT_EQ(run({"drives", "list", map()}), kOk);
  EXPECT_THAT(out_.str(), AllOf(HasSubstr("drive 0"), HasSubstr("session 1"), HasSubstr("12 images")));
  EXPECT_EQ(run({"closures", "list", map()}), kOk);
  EXPECT_THAT(out_.str(), AllOf(HasSubstr("loop"), HasSubstr("recognition"), Not(HasSubstr("rejected"))));
  EXPECT_EQ(run({"closures", "reject", map(), "12"}), kOk);
  EXPECT_EQ(run({"closures", "list", map()}), kOk);
  EXPECT_THAT(out_.str(), HasSubstr("rejected"));
  EXPECT_EQ(run({"reduce", map()}), kUsage);
  EXPECT_EQ(run({"crop", map(), "--region", "1,2,3"}), kUsage);
  EXPECT_EQ(run({"drives", "drop", map(), "9"}), kError);
  EXPECT_EQ(run({"merge", map(), map()}), kUsage);
}

TEST_F(MapKeeperTest, AMapMergedWithItselfIsItself) {
  EXPECT_EQ(run({"merge", map(), map(), "--out", path("c")}), kOk) << err_.str();
  EXPECT_EQ(dumpOf(path("c")), dumpOf(map()));
  EXPECT_EQ(run({"merge", map(), map(), "--out", path("c")}), kError);
  EXPECT_EQ(run({"check", path("c")}), kOk);
  EXPECT_EQ(run({"merge", map(), path("c"), "--into"}), kOk) << err_.str();
  EXPECT_EQ(dumpOf(path("c")), dumpOf(map()));
  EXPECT_EQ(dumpOf(map() + ".undo"), dumpOf(map()));
}

}  // namespace
}  // namespace engram::apps
