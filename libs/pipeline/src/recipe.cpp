// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/recipe.h"

#include "engram/base/error.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string_view>

namespace engram::pipeline {
namespace {

constexpr Recipe kPlaces{Perceive::kFeatures,   Move::kWheels,  Select::kMotion,  Recognise::kBelief,
                         Verify::kOneOnTerrain, Decide::kPlace, Remember::kPlace, Relate::kPlace,
                         Forget::kNothing,      Relax::kPlace};
constexpr Recipe kViews{Perceive::kPair,   Move::kEyes,   Select::kKeyframe, Recognise::kIndex,
                        Verify::kAllViews, Decide::kView, Remember::kView,   Relate::kView,
                        Forget::kLruViews, Relax::kView};
constexpr Recipe kScans{Perceive::kScan, Move::kWheels,   Select::kMotion, Recognise::kNear, Verify::kScans,
                        Decide::kScan,   Remember::kScan, Relate::kScan,   Forget::kNothing, Relax::kScan};
constexpr Recipe kLocalise{Perceive::kFeatures, Move::kWheels,  Select::kEvery,   Recognise::kBelief,
                           Verify::kOneOnWay,   Decide::kKnown, Remember::kLater, Relate::kFollow,
                           Forget::kNothing,    Relax::kNothing};

/// The systems of places differ in what scores a place and in how it remembers: [recognise] scorer and
/// [memory] memory.
constexpr std::array kRecipes{
    NamedRecipe{"fsh", "F: feature stability histograms", kPlaces},
    NamedRecipe{"multi_store", "D: the multi-store model of memory", kPlaces},
    NamedRecipe{"words", "A: incremental visual words", kPlaces},
    NamedRecipe{"views", "K: lifelong maps of stereo views", kViews},
    NamedRecipe{"scans", "V: visual scans with distinguishable points", kScans},
};

bool views(const PipelineParams& p) { return p.mapping.nodes == "views"; }
bool scans(const PipelineParams& p) { return p.mapping.nodes == "scans"; }
bool ofStereo(const PipelineParams& p) { return views(p) || scans(p); }
bool matches(const PipelineParams& p) {
  return p.recognise.scorer == "ltm_match" || p.recognise.scorer == "matched_points";
}
bool winner(const PipelineParams& p) { return p.belief.filter == "winner_takes_all"; }
bool filtered(const PipelineParams& p) { return p.posegraph.relaxer == "ekf_scans"; }

/// Keys of a section that a configuration makes ineffective; no keys: all of them.
struct Rule {
  std::string_view section;
  std::initializer_list<std::string_view> keys;
  bool (*inert)(const PipelineParams&);
  std::string_view why;
};

// clang-format off
const Rule kRules[] = {
    {"camera", {"fov_deg"}, [](const auto& p) { return !p.camera.file.empty(); },
     "[camera] file calibrates the camera"},
    {"camera", {"max_disparity"}, [](const auto& p) { return !p.camera.stereo; },
     "it needs [camera] stereo = true"},
    {"words", {}, [](const auto& p) { return p.recognise.scorer != "tfidf_incremental"; },
     "it needs [recognise] scorer = tfidf_incremental"},
    {"tree", {}, [](const auto& p) { return p.recognise.scorer != "vocabulary_tree" && !ofStereo(p); },
     "it needs [recognise] scorer = vocabulary_tree or [mapping] nodes = views or scans"},
    {"tree", {}, [](const auto& p) { return !p.views.vocabulary.empty(); },
     "[views] vocabulary names a tree that was trained before"},
    {"verify", {}, [](const auto& p) { return p.camera.stereo; },
     "with [camera] stereo = true the section [stereo] says how images are verified"},
    {"stereo", {}, [](const auto& p) { return !p.camera.stereo; }, "it needs [camera] stereo = true"},
    {"visual_odometry", {}, [](const auto& p) { return !views(p); }, "it needs [mapping] nodes = views"},
    {"select", {}, views, "with [mapping] nodes = views the section [views] says which images are taken up"},
    {"recognise", {"rescore"}, [](const auto& p) { return p.recognise.scorer != "tfidf_incremental"; },
     "it needs [recognise] scorer = tfidf_incremental"},
    {"recognise", {"exhaustive_places", "proposals"}, [](const auto& p) { return !matches(p); },
     "it needs [recognise] scorer = ltm_match or matched_points"},
    {"recognise", {"closure_similarity"}, ofStereo,
     "with [mapping] nodes = views or scans nothing is believed while mapping"},
    {"belief", {"new_place_prior", "new_place_persistence"}, ofStereo,
     "with [mapping] nodes = views or scans nothing is believed while mapping"},
    {"belief", {"sigma_hops", "expected_hops", "sigma_odometry", "hop_radius", "teleport", "new_place_prior",
                "new_place_persistence", "advance", "advance_max", "advance_resolution", "advance_persistence",
                "advance_blind", "advance_forgetting", "advance_headings", "view_sigma_deg"}, winner,
     "[belief] filter = winner_takes_all looks at each image by itself"},
    {"belief", {"sum_of_gaussians"},
     [](const auto& p) { return p.belief.likelihood == "angeli" || p.belief.likelihood == "standardised"; },
     "[belief] likelihood = angeli and standardised have rules of their own"},
    {"belief", {"floor"}, [](const auto& p) { return p.belief.likelihood == "standardised"; },
     "[belief] likelihood = standardised has background instead"},
    {"belief", {"evidence", "background"}, [](const auto& p) { return p.belief.likelihood != "standardised"; },
     "it needs [belief] likelihood = standardised"},
    {"appearance", {"evidence", "usual_similarity", "least_spread"},
     [](const auto& p) { return p.appearance.channel == "none"; }, "it needs [appearance] channel = thumbnail or hog"},
    {"belief", {"sigma_z_min"}, [](const auto& p) { return p.belief.sigma_z > 0; },
     "[belief] sigma_z is given"},
    {"belief", {"advance_max", "advance_resolution", "advance_persistence", "advance_forgetting"},
     [](const auto& p) { return p.belief.advance != "learned"; }, "it needs [belief] advance = learned"},
    {"belief", {"advance_headings", "view_sigma_deg"},
     [](const auto& p) { return p.belief.advance != "odometry"; }, "it needs [belief] advance = odometry"},
    {"belief", {"advance_blind"}, [](const auto& p) { return p.belief.advance == "none"; },
     "it needs [belief] advance = learned or odometry"},
    {"place", {"same_similarity", "patience"}, ofStereo,
     "with [mapping] nodes = views every keyframe is a node, with scans each that matches no other"},
    {"recognise", {"learn_hops", "learn_after"}, [](const auto& p) { return p.memory.gate == "none"; },
     "[memory] gate = none learns every image at once"},
    {"fsh", {}, [](const auto& p) { return p.memory.memory != "fsh"; }, "it needs [memory] memory = fsh"},
    {"multi_store", {}, [](const auto& p) { return p.memory.memory != "multi_store"; },
     "it needs [memory] memory = multi_store"},
    {"posegraph", {"duckett_max_sweeps", "duckett_tolerance"},
     [](const auto& p) { return p.posegraph.relaxer != "duckett"; }, "it needs [posegraph] relaxer = duckett"},
    {"posegraph", {"gate_probability", "gate_inflation", "gate_lone_sigma", "gate_support_sigma", "gate_support",
                   "review_inflation"}, views,
     "with [mapping] nodes = views the section [views] says which links agree with the graph"},
    {"posegraph", {"kernel", "kernel_width", "max_iterations", "max_seconds", "window_hops", "window_places",
                   "window_iterations", "gate_inflation", "gate_lone_sigma", "gate_support_sigma", "gate_support",
                   "review_inflation"}, filtered, "[posegraph] relaxer = ekf_scans filters and relaxes no graph"},
    {"views", {"vocabulary", "candidates", "train_after", "retrain_growth"},
     [](const auto& p) { return !ofStereo(p) && p.recognise.scorer != "vocabulary_tree"; },
     "it needs [mapping] nodes = views or scans or [recognise] scorer = vocabulary_tree"},
    {"views", {"min_interval", "max_features", "agree_distance", "agree_angle_deg", "max_drift", "max_speed", "wheels",
               "relax_sigma", "relax_all_sigma"},
     [](const auto& p) { return !views(p); }, "it needs [mapping] nodes = views"},
    {"views", {"sure_inliers", "sigma_floor", "weak_sigma"},
     [](const auto& p) { return !ofStereo(p); }, "it needs [mapping] nodes = views or scans"},
    {"scans", {}, [](const auto& p) { return !scans(p); }, "it needs [mapping] nodes = scans"},
    {"views", {"train_after", "retrain_growth"}, [](const auto& p) { return !p.views.vocabulary.empty(); },
     "[views] vocabulary names a tree that was trained before"},
    {"upkeep", {"upkeep", "max_views", "neighbourhood_distance", "neighbourhood_angle", "search_distance",
                "search_sigma", "max_closeness", "view_features", "probation", "touch_on_match"},
     [](const auto& p) { return !views(p); },
     "it needs [mapping] nodes = views: places forget features, not themselves"},
    {"upkeep", {"max_views", "neighbourhood_distance", "neighbourhood_angle", "search_distance",
                "search_sigma", "max_closeness", "view_features", "probation", "touch_on_match"},
     [](const auto& p) { return p.upkeep.upkeep == "none"; }, "it needs [upkeep] upkeep = lru_views"},
    {"upkeep", {"view_features"}, [](const auto& p) { return p.upkeep.max_closeness > 0; },
     "[upkeep] max_closeness is given"},
};
// clang-format on

/// Whole images are compared by the thumbnails that the map keeps.
void requirePictures(const PipelineParams& p) {
  constexpr int kLeast = 64;  // [px]
  if (p.appearance.channel != "none" && p.place.keep_thumbnails < kLeast)
    throw base::ConfigError("[appearance] channel = " + p.appearance.channel +
                            " needs [place] keep_thumbnails of " + std::to_string(kLeast) +
                            " or more: it compares the thumbnails of the places");
}

/// One image, one kind of evidence: there is nothing to weigh a second one against.
void requireOneWitness(const PipelineParams& p) {
  if (winner(p) && p.appearance.channel != "none")
    throw base::ConfigError("[belief] filter = winner_takes_all needs [appearance] channel = none, not " +
                            p.appearance.channel);
}

void requireStereo(const PipelineParams& p) {
  const std::string nodes = "[mapping] nodes = " + p.mapping.nodes;
  if (!p.camera.stereo)
    throw base::ConfigError(nodes +
                            " needs both eyes of a stereo camera: set [camera] stereo = true and "
                            "file to its calibration");
  if (p.memory.memory != "static")
    throw base::ConfigError(nodes + " needs [memory] memory = static, not " + p.memory.memory +
                            ": a view is kept or forgotten as a whole");
}

void requireNoUpkeep(const PipelineParams& p) {
  if (p.upkeep.upkeep != "none")
    throw base::ConfigError("[upkeep] upkeep = " + p.upkeep.upkeep +
                            " needs [mapping] nodes = views: places forget features, not themselves");
}

void requirePlaces(const PipelineParams& p) {
  if (p.camera.stereo && p.memory.memory != "static")
    throw base::ConfigError("[camera] stereo = true needs [memory] memory = static, not " + p.memory.memory +
                            ": the 3D points of a place are those that one view of it has");
  requireNoUpkeep(p);
}

}  // namespace

std::span<const NamedRecipe> recipes() { return kRecipes; }

const NamedRecipe& recipeOf(const PipelineParams& params) {
  requirePictures(params);
  requireOneWitness(params);
  ofStereo(params) ? requireStereo(params) : requirePlaces(params);
  if (filtered(params) && !scans(params))
    throw base::ConfigError("[posegraph] relaxer = ekf_scans needs [mapping] nodes = scans");
  if (scans(params)) requireNoUpkeep(params);
  if (ofStereo(params)) return kRecipes[views(params) ? 3 : 4];
  if (params.recognise.scorer == "tfidf_incremental") return kRecipes[2];
  return params.memory.memory == "multi_store" ? kRecipes[1] : kRecipes[0];
}

Recipe recipeFor(const PipelineParams& params, Use use) {
  if (use != Use::kBuild) {
    Recipe recipe = kLocalise;
    if (params.memory.gate == "none") recipe.remember = Remember::kUngated;
    if (use == Use::kFrozen) recipe.remember = Remember::kNothing;
    return recipe;
  }
  Recipe recipe = recipeOf(params).build;
  if (params.upkeep.upkeep == "none") recipe.forget = Forget::kNothing;
  return recipe;
}

std::string whyInert(const PipelineParams& params, const std::string& section, const std::string& key) {
  for (const Rule& rule : kRules) {
    if (rule.section != section) continue;
    const bool named = rule.keys.size() == 0 || std::ranges::find(rule.keys, key) != rule.keys.end();
    if (named && rule.inert(params)) return std::string(rule.why);
  }
  return {};
}

std::vector<std::pair<std::string, std::string>> ruledKeys() {
  std::vector<std::pair<std::string, std::string>> ruled;
  for (const Rule& rule : kRules) {
    if (rule.keys.size() == 0) ruled.emplace_back(rule.section, "");
    for (const auto& key : rule.keys) ruled.emplace_back(rule.section, key);
  }
  return ruled;
}

void requireEffect(const base::IniFile& ini, const PipelineParams& params, const std::string& origin) {
  for (const auto& [section, keys] : ini.sections())
    for (const auto& [key, value] : keys) {
      if (!origin.empty() && value.origin != origin) continue;
      if (const std::string why = whyInert(params, section, key); !why.empty())
        throw base::ConfigError(value.origin + ": [" + section + "] " + key + " has no effect: " + why +
                                "; take it out");
    }
}

}  // namespace engram::pipeline
