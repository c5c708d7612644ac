// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "map_program.h"

#include "engram/store/map_file.h"
#include "engram/vocabulary/vocabulary_tree.h"
#include "sample_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <unistd.h>

namespace engram::apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class MapProgramTest : public ::testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/engram_map_XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    folder_ = name;
    auto map = testing::ringMap(5);
    map::MapHeader header;
    header.engramVersion = "0.1.0";
    header.camera = "model = unified_sphere\nxi = 0.9\n";
    header.extractor = "surf";
    header.descriptorDim = 64;
    header.memoryModel = "fsh";
    types::FrameReport report;
    report.milliseconds = 5;
    store::MapFile::create(path("m.engram"), header).commit(map, map.takeChanges(), &report);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  int run(const std::vector<std::string>& arguments) {
    MapProgram program;
    out_.str("");
    err_.str("");
    return runProgram(program, arguments, out_, err_);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static std::string read(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  std::filesystem::path folder_;
  std::ostringstream out_, err_;
};

TEST_F(MapProgramTest, InfoPrintsAndWritesTheFigures) {
  EXPECT_EQ(run({"info", path("m.engram"), "--json", path("m.json")}), kOk);
  EXPECT_THAT(out_.str(), AllOf(HasSubstr("5 in 1 connected part(s)"), HasSubstr("5 (loop 1, odometry 4)"),
                                HasSubstr("surf, int8 descriptors of 64")));
  const auto json = nlohmann::json::parse(read(path("m.json")));
  EXPECT_EQ(json.at("places"), 5);
  EXPECT_EQ(json.at("views"), 5);
  EXPECT_EQ(json.at("edges_by_type").at("loop"), 1);
  EXPECT_EQ(json.at("records"), 1);
  EXPECT_EQ(json.at("map_bytes"), std::filesystem::file_size(path("m.engram")));
  // A regular pentagon of radius 10 m, four of its five sides.
  EXPECT_NEAR(json.at("path_length_m").get<double>(), 4 * 20 * std::sin(M_PI / 5), 1e-9);
  EXPECT_EQ(run({"info", "-q", path("m.engram")}), kOk);
  EXPECT_THAT(out_.str(), IsEmpty());
}

TEST_F(MapProgramTest, CheckFindsDamage) {
  EXPECT_EQ(run({"check", path("m.engram")}), kOk);
  EXPECT_THAT(out_.str(), HasSubstr("sound"));
  std::string bytes = read(path("m.engram"));
  bytes[bytes.find("image_3.png")] = 'X';
  std::ofstream(path("m.engram"), std::ios::binary) << bytes;
  EXPECT_EQ(run({"check", "-q", path("m.engram")}), kError);
  EXPECT_THAT(out_.str(), HasSubstr("place 3: its checksum is wrong"));
  EXPECT_EQ(run({"info", path("m.engram")}), kError);
  EXPECT_THAT(err_.str(), HasSubstr("place 3: its checksum is wrong"));
}

/// What a map of someone else may say to a terminal, and to the reader of a JSON file.
TEST_F(MapProgramTest, TextOfAMapIsShownAndNotObeyed) {
  auto map = testing::ringMap(3);
  map::MapHeader header;
  header.camera = "\x1b]0;owned\x07\x1b[2J\xff";
  header.memoryModel = "fsh\xc2\x9b\u202E";
  header.parameters = "a = \x1b[31m\n";
  header.descriptorDim = 64;
  types::FrameReport report;
  report.label = "\x7f\xc2\x9b";
  store::MapFile::create(path("b.engram"), header).commit(map, map.takeChanges(), &report);
  for (const std::string command : {"info", "check", "dump"}) {
    EXPECT_EQ(run({command, path("b.engram")}), kOk) << err_.str();
    for (const char* raw : {"\x1b", "\x07", "\xff", "\x7f", "\xc2\x9b", "\u202E"})
      EXPECT_THAT(out_.str() + err_.str(), Not(HasSubstr(raw))) << command;
  }
  EXPECT_EQ(run({"info", path("b.engram"), "--json", path("b.json")}), kOk) << err_.str();
  EXPECT_THAT(out_.str(), HasSubstr("\\x1b]0;owned\\x07\\x1b[2J\\xff"));
  EXPECT_EQ(nlohmann::json::parse(read(path("b.json"))).at("camera"), "\x1b]0;owned\x07\x1b[2J\uFFFD");
  EXPECT_EQ(run({"info", path("\x1b[2J")}), kError);
  EXPECT_THAT(err_.str(), AllOf(HasSubstr("\\x1b[2J"), Not(HasSubstr("\x1b"))));
}

TEST_F(MapProgramTest, DumpEqualsTheStore) {
  EXPECT_EQ(run({"dump", path("m.engram")}), kOk);
  std::ostringstream expected;
  store::MapFile::open(path("m.engram"), store::Access::kReadOnly).dump(expected);
  EXPECT_EQ(out_.str(), expected.str());
}

TEST_F(MapProgramTest, ExportsEveryFormatAndLeavesTheMapAlone) {
  const std::string before = read(path("m.engram"));
  for (const std::string format : {"3dscene", "graph", "tum", "html", "dot"}) {
    const std::string file = path("out." + format);
    EXPECT_EQ(run({"export", path("m.engram"), "--format", format, "--out", file}), kOk) << err_.str();
    EXPECT_GT(std::filesystem::file_size(file), 100u) << format;
    EXPECT_EQ(run({"export", path("m.engram"), "--format", format, "--out", file}), kError);
    EXPECT_THAT(err_.str(), HasSubstr("exists already"));
    EXPECT_EQ(
        run({"export", path("m.engram"), "--format", format, "--out", file, "--overwrite", "--images", "-q"}),
        kOk);
    EXPECT_THAT(out_.str(), IsEmpty());
  }
  EXPECT_THAT(read(path("out.graph")), HasSubstr("EDGE3"));
  EXPECT_THAT(read(path("out.html")), HasSubstr("<title>Engram map m.engram</title>"));
  EXPECT_EQ(read(path("m.engram")), before);
}

TEST_F(MapProgramTest, TrainsAVocabularyOnMaps) {
  const std::string before = read(path("m.engram")), file = path("v.vocabulary");
  std::filesystem::copy(path("m.engram"), path("n.engram"));
  const std::vector<std::string> command{
      "train-vocabulary",      path("m.engram"), path("n.engram"), "--out", file, "--set",
      "vocabulary.branching=4"};
  EXPECT_EQ(run(command), kOk) << err_.str();
  EXPECT_THAT(out_.str(), HasSubstr("200 descriptors of 10 places"));
  // The same as the library makes of the same places.
  const auto map = store::MapFile::open(path("m.engram"), store::Access::kReadOnly).load();
  std::vector<const types::Descriptors*> views;
  for (int twice = 0; twice < 2; ++twice)
    for (const auto& [id, place] : map.places()) views.push_back(&place.memory->features.descriptors);
  vocabulary::TreeParams params;
  params.branching = 4;
  EXPECT_EQ(vocabulary::VocabularyTree::load(file), vocabulary::VocabularyTree::train(views, params));
  EXPECT_EQ(read(path("m.engram")), before);

  EXPECT_EQ(run(command), kError);
  EXPECT_THAT(err_.str(), HasSubstr("exists already"));
  EXPECT_EQ(run({"train-vocabulary", path("m.engram"), "--out", file, "--overwrite", "-q"}), kOk);
  EXPECT_THAT(out_.str(), IsEmpty());
}

TEST_F(MapProgramTest, RefusesMapsThatNoVocabularyFits) {
  map::MapHeader header;
  header.extractor = "orb";
  header.descriptorKind = types::DescriptorKind::kBinary;
  header.descriptorDim = 256;
  map::TopologicalMap empty;
  store::MapFile::create(path("orb.engram"), header).commit(empty, empty.takeChanges());
  const std::string file = path("v.vocabulary");
  EXPECT_EQ(run({"train-vocabulary", path("m.engram"), path("orb.engram"), "--out", file}), kError);
  EXPECT_THAT(err_.str(), AllOf(HasSubstr("orb.engram"), HasSubstr("one extractor")));
  EXPECT_EQ(run({"train-vocabulary", path("orb.engram"), "--out", file}), kError);
  EXPECT_THAT(err_.str(), HasSubstr("no descriptors"));
  EXPECT_EQ(run({"train-vocabulary", path("m.engram"), "--out", file, "--set", "vocabulary.branchin=4"}),
            kError);
  EXPECT_THAT(err_.str(), HasSubstr("branching"));
  EXPECT_EQ(run({"train-vocabulary", path("m.engram"), "--out", path("no/such/x")}), kError);
  EXPECT_EQ(run({"train-vocabulary", "--out", file}), kUsage);
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_EQ(run({"train-vocabulary", path("m.engram"), "--out", file, "--dump-config"}), kOk);
  EXPECT_THAT(out_.str(), HasSubstr("max_training = 200000"));
}

TEST_F(MapProgramTest, BadUseAndBadInput) {
  EXPECT_EQ(run({}), kUsage);
  EXPECT_EQ(run({"info"}), kUsage);
  EXPECT_EQ(run({"export", path("m.engram"), "--format", "png", "--out", "x"}), kUsage);
  EXPECT_EQ(run({"info", path("none.engram")}), kError);
  EXPECT_THAT(err_.str(), AllOf(HasSubstr("none.engram"), HasSubstr("does not exist")));
  EXPECT_EQ(run({"export", path("m.engram"), "--format", "tum", "--out", path("no/such/x")}), kError);
  EXPECT_THAT(err_.str(), HasSubstr("no/such"));
  EXPECT_EQ(run({"info", path("m.engram"), "--json", path("no/such/x")}), kError);
  EXPECT_EQ(run({"--help"}), kOk);
  EXPECT_THAT(out_.str(), AllOf(HasSubstr("Examples"), HasSubstr("Exit codes")));
}

}  // namespace
}  // namespace engram::apps
