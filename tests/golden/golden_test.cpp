// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/atomic_file.h"
#include "engram/pipeline/pipeline.h"
#include "engram/store/map_file.h"
#include "engram/store/report_json.h"
#include "golden_drives.h"
#include "golden_origin.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <set>
#include <sstream>

namespace engram::testing {
namespace {

using Hashes = std::map<std::string, std::string>;  // by the name of a case and what was hashed

const char* const kFile = ENGRAM_SOURCE_DIR "/tests/fixtures/golden.txt";

/// Every shipped configuration; live_omni is fsh_omni with a camera, as the last test holds.
const std::vector<GoldenCase>& cases() {
  static const std::vector<GoldenCase> all{
      {"fsh_omni", "omni"},
      {"multi_store_omni", "omni"},
      {"fsh_mono", "pinhole"},
      {"words_mono", "pinhole"},
      {"words_odometry", "pinhole"},
      {"fsh_pano", "pano"},
      {"view_map", "stereo"},
      {"view_map", "stereo", {"upkeep.upkeep=lru_views", "upkeep.max_views=2"}, "+lru"},
      {"view_map",
       "stereo",
       {"mapping.nodes=places", "recognise.closure_similarity=0.1", "select.min_distance=0.2",
        "place.spacing=0.4"},
       "+places"},
      {"visual_scans", "stereo"},
      {"visual_scans", "stereo", {"posegraph.relaxer=ceres"}, "+graph"},
      {"paper_scans", "stereo"},
      {"paper_fsh", "omni"},
      {"paper_stm_ltm", "omni"},
      {"paper_words", "pinhole"},
      {"paper_views", "stereo"},
  };
  return all;
}

/// FNV-1a over 64 bits.
std::string hashOf(const std::string& text) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  std::ostringstream hex;
  hex << std::hex << std::setw(16) << std::setfill('0') << hash;
  return hex.str();
}

/// Its first line is the version of the format, which is no result: it stays that of the kept hashes.
std::string dumpOf(const map::TopologicalMap& map, const map::MapHeader& header) {
  std::ostringstream out;
  store::dump(out, header, map.content(), {});
  const std::string text = out.str();
  return "engram_map 2" + text.substr(text.find('\n'));
}

std::string linesOf(const std::vector<types::FrameReport>& reports) {
  std::string lines;
  for (const auto& report : reports) lines += store::toJson(report, false) + "\n";
  return lines;
}

/// What the places were, without figures: it stays when only the last bits change.
std::string decisionsOf(const std::vector<types::FrameReport>& reports) {
  std::ostringstream out;
  for (const auto& r : reports)
    out << r.index << ' ' << types::toString(r.outcome) << ' '
        << (r.place.valid() ? static_cast<int>(r.place.value) : -1) << ' ' << r.closure << '\n';
  return out.str();
}

/// The text of a map as another program would read it: nothing but the content survives.
map::TopologicalMap reread(const map::TopologicalMap& map) {
  return map::TopologicalMap(map::MapContent(map.content()));
}

class GoldenRun {
 public:
  explicit GoldenRun(const GoldenCase& golden)
      : name_(golden.name()), params_(goldenParams(golden)), drives_(goldenDrives(golden.eye)) {}

  /// Maps the first day, extends it by the second, and localises the second in the map of the first, frozen
  /// and adapting.
  Hashes run() {
    const map::TopologicalMap first = mapped("map", {}, drives_.first);
    mapped("extend", reread(first), drives_.second);
    localised("localise", reread(first), false);
    localised("adapt", reread(first), true);
    return std::move(hashes_);
  }

 private:
  map::TopologicalMap mapped(const std::string& what, map::TopologicalMap known,
                             const std::vector<types::Frame>& frames) {
    pipeline::Pipeline mapper(params_, std::move(known));
    std::vector<types::FrameReport> reports;
    for (const auto& frame : frames) reports.push_back(mapper.process(frame));
    mapper.finish();
    keep(what, mapper.map(), mapper.header(), reports);
    return mapper.map();
  }

  void localised(const std::string& what, map::TopologicalMap known, bool adapt) {
    const auto use = adapt ? pipeline::Use::kAdapting : pipeline::Use::kFrozen;
    pipeline::Pipeline localizer(params_, std::move(known), use);
    std::vector<types::FrameReport> reports;
    for (const auto& frame : drives_.second) reports.push_back(localizer.process(frame));
    localizer.finish();
    keep(what, localizer.map(), localizer.header(), reports);
  }

  void keep(const std::string& what, const map::TopologicalMap& map, const map::MapHeader& header,
            const std::vector<types::FrameReport>& reports) {
    const std::string key = name_ + " " + what;
    hashes_[key + " map"] = hashOf(dumpOf(map, header));
    hashes_[key + " decisions"] = hashOf(decisionsOf(reports));
    hashes_[key + " records"] = hashOf(linesOf(reports));
    if (const char* folder = std::getenv("ENGRAM_GOLDEN_KEEP"))  // to see what differs
      base::writeText(std::string(folder) + "/" + key + ".txt", dumpOf(map, header) + linesOf(reports), true);
  }

  std::string name_;
  pipeline::PipelineParams params_;
  const GoldenDrives& drives_;
  Hashes hashes_;
};

/// Lines `case what = hash`; the first names the origin of the hashes, `#` begins a comment.
struct GoldenFile {
  std::string origin;
  Hashes hashes;
};

GoldenFile readGolden() {
  GoldenFile file;
  std::ifstream in(kFile);
  EXPECT_TRUE(in) << kFile;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line.front() == '#') continue;
    const auto equals = line.rfind(" = ");
    if (equals == std::string::npos) continue;
    const std::string key = line.substr(0, equals), value = line.substr(equals + 3);
    (key == "origin" ? file.origin : file.hashes[key]) = value;
  }
  return file;
}

class Golden : public ::testing::TestWithParam<GoldenCase> {};

/// The compiler and the libraries of an origin, without the processor.
std::string toolsOf(const std::string& origin) {
  return origin.substr(std::min(origin.find(';'), origin.size()));
}

/// On a machine of the kind that the kept hashes come from, every result is as it was, to the last bit. On
/// another processor the last bits may differ, what was decided does not. With other libraries nothing can be
/// compared but the same run with itself.
TEST_P(Golden, ResultsAreAsTheyWere) {
  const GoldenFile kept = readGolden();
  const std::string here = goldenOrigin();
  const Hashes now = GoldenRun(GetParam()).run();
  if (toolsOf(kept.origin) != toolsOf(here)) {
    EXPECT_EQ(GoldenRun(GetParam()).run(), now);
    std::cout << "the kept hashes come from " << kept.origin << "; here: " << here
              << ": two runs were compared instead\n";
    return;
  }
  for (const auto& [key, hash] : now) {
    if (kept.origin != here && !key.ends_with(" decisions")) continue;
    const auto at = kept.hashes.find(key);
    const std::string expected = at == kept.hashes.end() ? "none" : at->second;
    EXPECT_EQ(hash, expected) << "if that is meant, put into " << kFile << ":\n" << key << " = " << hash;
  }
}

INSTANTIATE_TEST_SUITE_P(Configurations, Golden, ::testing::ValuesIn(cases()), [](const auto& test) {
  std::string name = test.param.name();
  for (char& c : name)
    if (c == '+') c = '_';
  return name;
});

TEST(GoldenCases, CoverEveryShippedConfiguration) {
  std::set<std::string> covered{"live_omni"};
  for (const GoldenCase& golden : cases()) covered.insert(golden.config);
  for (const auto& entry : std::filesystem::directory_iterator(ENGRAM_SOURCE_DIR "/config"))
    EXPECT_TRUE(entry.path().extension() != ".ini" || covered.contains(entry.path().stem().string()))
        << entry;
}

TEST(GoldenCases, TheLiveConfigurationIsFshOmniWithACamera) {
  const auto dump = [](const std::string& name) {
    pipeline::PipelineParams params = goldenParams({name, "omni"});
    base::Config config;
    params.bind(config);
    return config.dump();
  };
  EXPECT_EQ(dump("live_omni"), dump("fsh_omni"));
}

}  // namespace
}  // namespace engram::testing
