// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/recipe.h"

#include "engram/base/error.h"
#include "engram/pipeline/pipeline.h"
#include "tiny_drive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

namespace engram::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Read {
  PipelineParams params;
  base::IniFile ini;
};

Read read(base::IniFile ini) {
  for (const char* live : {"front", "front.features"}) ini.take(live);
  Read result{{}, std::move(ini)};
  base::Config config;
  result.params.bind(config);
  config.read(result.ini);
  return result;
}

/// What is said of a configuration; empty when every key has an effect.
std::string complaint(const std::string& text) {
  const Read r = read(base::IniFile::parse(text, "x.ini"));
  try {
    requireEffect(r.ini, r.params);
  } catch (const base::ConfigError& e) {
    return e.what();
  }
  return {};
}

std::vector<std::filesystem::path> shipped() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(ENGRAM_SOURCE_DIR "/config"))
    if (entry.path().extension() == ".ini") files.push_back(entry.path());
  return files;
}

TEST(Recipe, EveryKeyOfAShippedConfigurationHasAnEffect) {
  ASSERT_GE(shipped().size(), 8u);
  for (const auto& file : shipped()) {
    const Read r = read(base::IniFile::load(file.string()));
    EXPECT_NO_THROW(requireEffect(r.ini, r.params)) << file;
    EXPECT_NO_THROW(recipeOf(r.params)) << file;
  }
}

TEST(Recipe, ShippedConfigurationsAreTheSystemsOfTheirPapers) {
  const auto nameOf = [](const std::string& config) {
    return std::string(
        recipeOf(read(base::IniFile::load(ENGRAM_SOURCE_DIR "/config/" + config + ".ini")).params).name);
  };
  EXPECT_EQ(nameOf("fsh_omni"), "fsh");
  EXPECT_EQ(nameOf("multi_store_omni"), "multi_store");
  EXPECT_EQ(nameOf("words_odometry"), "words");
  EXPECT_EQ(nameOf("view_map"), "views");
  EXPECT_EQ(nameOf("visual_scans"), "scans");
  EXPECT_EQ(nameOf("paper_scans"), "scans");
  EXPECT_EQ(nameOf("paper_fsh"), "fsh");
  EXPECT_EQ(nameOf("paper_stm_ltm"), "multi_store");
  EXPECT_EQ(nameOf("paper_words"), "words");
  EXPECT_EQ(nameOf("paper_views"), "views");
}

TEST(Recipe, AKeyWithoutEffectIsRefusedWithFileLineSectionAndKey) {
  EXPECT_THAT(complaint("[place]\nspacing = 1\n\n[views]\nmin_interval = 2\n"),
              AllOf(HasSubstr("x.ini:5: [views] min_interval has no effect"),
                    HasSubstr("it needs [mapping] nodes = views")));
}

struct Inert {
  const char* text;    ///< with a key that has no effect
  const char* key;     ///< that one
  const char* remedy;  ///< with this before it the key has one
};

class InertKeys : public ::testing::TestWithParam<Inert> {};

TEST_P(InertKeys, AreNamedAndHaveAnEffectWhereTheReasonSays) {
  const auto& [text, key, remedy] = GetParam();
  EXPECT_THAT(complaint(text), AllOf(HasSubstr(key), HasSubstr("has no effect"))) << text;
  EXPECT_THAT(complaint(std::string(remedy) + text), IsEmpty()) << remedy << text;
}

const char* const kViewMap = "[mapping]\nnodes = views\n[memory]\nmemory = static\n";

INSTANTIATE_TEST_SUITE_P(
    Recipe, InertKeys,
    ::testing::Values(
        Inert{"[camera]\nmax_disparity = 64\n", "[camera] max_disparity", "[camera]\nstereo = true\n"},
        Inert{"[words]\nchecks = 32\n", "[words] checks", "[recognise]\nscorer = tfidf_incremental\n"},
        Inert{"[recognise]\nrescore = 10\n", "[recognise] rescore",
              "[recognise]\nscorer = tfidf_incremental\n"},
        Inert{"[tree]\nbranching = 8\n", "[tree] branching", "[recognise]\nscorer = vocabulary_tree\n"},
        Inert{"[stereo]\nmin_inliers = 20\n", "[stereo] min_inliers", "[camera]\nstereo = true\n"},
        Inert{"[belief]\nview_sigma_deg = 30\n", "[belief] view_sigma_deg", "[belief]\nadvance = odometry\n"},
        Inert{"[belief]\nfloor = 0.1\n", "[belief] floor", "[belief]\nlikelihood = gaussian\n"},
        Inert{"[appearance]\nevidence = 1\n", "[appearance] evidence", "[appearance]\nchannel = hog\n"},
        Inert{"[multi_store]\nstm_states = 2\n", "[multi_store] stm_states",
              "[memory]\nmemory = multi_store\n"},
        Inert{"[posegraph]\nduckett_tolerance = 0.001\n", "[posegraph] duckett_tolerance",
              "[posegraph]\nrelaxer = duckett\n"},
        Inert{"[views]\nmin_interval = 1\n", "[views] min_interval", kViewMap},
        Inert{"[upkeep]\nupkeep = lru_views\n", "[upkeep] upkeep", kViewMap},
        Inert{"[upkeep]\nmax_views = 5\n", "[upkeep] max_views",
              "[mapping]\nnodes = views\n[upkeep]\nupkeep = lru_views\n"}));

TEST(Recipe, AWinnerAndAnOpenGateMakeKeysIneffective) {
  for (const std::string text : {"teleport = 0.1\n", "advance = none\n", "sigma_hops = 1\n"}) {
    EXPECT_THAT(complaint("[belief]\n" + text), IsEmpty()) << text;
    EXPECT_THAT(complaint("[belief]\nfilter = winner_takes_all\n" + text), HasSubstr("by itself")) << text;
  }
  const std::string lesson = "[recognise]\nlearn_after = 2\n";
  EXPECT_THAT(complaint(lesson), IsEmpty());
  EXPECT_THAT(complaint("[memory]\ngate = none\n" + lesson), HasSubstr("learns every image at once"));
}

/// The other way round: what maps of views do not look at.
TEST(Recipe, KeysOfPlacesHaveNoEffectOnViews) {
  for (const std::string text :
       {"[select]\nmin_distance = 1\n", "[place]\npatience = 3\n", "[belief]\nnew_place_prior = 0.2\n",
        "[recognise]\nclosure_similarity = 0.3\n", "[posegraph]\ngate_support = 4\n"}) {
    EXPECT_THAT(complaint(text), IsEmpty()) << text;
    EXPECT_THAT(complaint(kViewMap + text), HasSubstr("has no effect")) << text;
  }
  // The robot is localised in a map of views by belief: these have an effect there.
  EXPECT_THAT(complaint(std::string(kViewMap) + "[belief]\naccept_hops = 3\n[place]\nspacing = 0.5\n"),
              IsEmpty());
}

/// A misspelt key in a rule would never be refused.
TEST(Recipe, EveryKeyThatARuleNamesIsAKey) {
  PipelineParams params;
  base::Config config;
  params.bind(config);
  std::set<std::pair<std::string, std::string>> known;
  config.dump([&](const std::string& section, const std::string& key) {
    known.insert({section, key});
    known.insert({section, ""});  // all of a section
    return std::string();
  });
  ASSERT_GT(ruledKeys().size(), 50u);
  for (const auto& ruled : ruledKeys())
    EXPECT_TRUE(known.contains(ruled)) << ruled.first << ' ' << ruled.second;
}

TEST(Recipe, ADumpMarksKeysWithoutEffectAndCanBeRead) {
  for (const auto& file : shipped()) {
    Read r = read(base::IniFile::load(file.string()));
    base::Config config;
    r.params.bind(config);
    const std::string text = config.dump(
        [&](const std::string& section, const std::string& key) { return whyInert(r.params, section, key); });
    EXPECT_THAT(text, HasSubstr("# without effect: "));
    EXPECT_THAT(complaint(text), IsEmpty()) << file;
  }
}

TEST(Recipe, CombinationsThatNoSystemHasAreRefused) {
  const auto refusal = [](const PipelineParams& params) {
    try {
      Pipeline pipeline(params);
    } catch (const base::ConfigError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  PipelineParams params = engram::testing::tinyParams();
  params.upkeep.upkeep = "lru_views";
  EXPECT_THAT(refusal(params), AllOf(HasSubstr("[upkeep] upkeep = lru_views"), HasSubstr("nodes = views")));
  params = engram::testing::tinyParams();
  params.appearance.channel = "hog";
  params.place.keep_thumbnails = 32;
  EXPECT_THAT(refusal(params), HasSubstr("keep_thumbnails of 64 or more"));
  params = engram::testing::tinyParams();
  params.belief.filter = "winner_takes_all";
  params.appearance.channel = "hog";
  EXPECT_THAT(refusal(params), HasSubstr("winner_takes_all needs [appearance] channel = none"));
  params = engram::testing::tinyParams();
  params.mapping.nodes = "views";
  EXPECT_THAT(refusal(params), HasSubstr("both eyes of a stereo camera"));
  params.camera.stereo = true;
  EXPECT_THAT(refusal(params), HasSubstr("memory = static, not fsh"));
  params.mapping.nodes = "places";
  EXPECT_THAT(refusal(params), HasSubstr("memory = static, not fsh"));
}

}  // namespace
}  // namespace engram::pipeline
