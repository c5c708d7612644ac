// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/params.h"

namespace engram::pipeline {

void SelectParams::describe(base::Params& p) {
  p.add("min_distance", min_distance, "with odometry: distance from one keyframe to the next [m]", {0, 100});
  p.addDegrees("min_rotation_deg", min_rotation,
               "with odometry: or rotation from one keyframe to the next [deg]", {0, 180});
  p.add("standing_similarity", standing_similarity,
        "without odometry: an image this similar to the last keyframe is dropped", {0, 1});
}

void PlaceParams::describe(base::Params& p) {
  p.add("spacing", spacing, "with odometry: distance from all places at which an image makes a new one [m]",
        {0.05, 100});
  p.add("same_similarity", same_similarity,
        "without odometry: an image this similar to a place just made belongs to it", {0, 1});
  p.add("recent_hops", recent_hops,
        "places this near to the newest one in the graph are no loop closure [edges]", {0, 1000});
  p.add("patience", patience, "unrecognised images in a row in known territory before new places are made",
        {1, 1000});
  p.add("keep_thumbnails", keep_thumbnails, "width of the stored thumbnail of a place [px]; 0 stores none",
        {0, 1024});
}

void RecogniseParams::describe(base::Params& p) {
  p.addChoice("scorer", scorer,
              "what scores the places: matches with long-term features, votes of the words of an incremental "
              "dictionary, or of those of a vocabulary tree",
              {"ltm_match", "tfidf_incremental", "vocabulary_tree"});
  p.add("exhaustive_places", exhaustive_places,
        "ltm_match: in a map of more places an index proposes those that are matched", {1, 1e9});
  p.add("proposals", proposals, "ltm_match: places that the index proposes", {1, 1e6});
  p.add("rescore", rescore,
        "tfidf_incremental: so many places with the most votes are scored again as by ltm_match; 0 leaves it "
        "to "
        "the votes",
        {0, 1e6});
  p.add("verified_scores", verified_scores,
        "so many places with the best scores are verified at once: their score counts the matches that "
        "geometry "
        "confirms, and that of all others is 0; 0 leaves it to the descriptors",
        {0, 1000});
  p.add("candidates", candidates, "hypotheses that go to geometric verification", {1, 1000});
  p.add("reported", reported, "hypotheses in the record of an image, if they are more than the candidates",
        {1, 1000});
  p.add("accept_inliers", accept_inliers, "verified matches that acceptance needs", {4, 10000});
  p.add("accept_log10_nfa", accept_log10_nfa,
        "or verified matches, however few, of which unrelated images have as many in one of 10^-x cases",
        {-1e3, 0});
  p.add("ambiguity", ambiguity,
        "a leap through the map is refused when a place far from there has this share of its verified "
        "matches; 0: never",
        {0, 1});
  p.add("sequence", sequence,
        "localising: images in a row that together may say where the robot is while none has matches enough; "
        "nothing is learnt from it; 0: never",
        {0, 1000});
  p.add("closure_inliers", closure_inliers, "verified matches that a loop closure needs", {4, 10000});
  p.add(
      "sure_inliers", sure_inliers,
      "verified matches with which the best verified of the most similar places is accepted while the belief "
      "is undecided; 0: never",
      {0, 10000});
  p.add("closure_similarity", closure_similarity,
        "while mapping: similarity that different places of one building show, instead of [belief] "
        "new_place_similarity; without odometry a new place counts with it",
        {0, 1});
  p.add("accept_similarity", accept_similarity, "similarity over verified matches that acceptance needs",
        {0, 1});
  p.add("learn_hops", learn_hops,
        "while localising, a place learns when the robot is more than so many edges away from it", {0, 1000});
  p.add("learn_after", learn_after,
        "localising: accepted images in a row that agree with odometry before a place learns", {1, 1000});
  p.add("threads", threads, "threads of the search; the result does not depend on it", {1, 64});
}

void OdometryParams::describe(base::Params& p) {
  p.add("sigma_per_metre", sigma_per_metre, "noise of the position [m per m]", {0, 1});
  p.addDegrees("sigma_heading_per_metre_deg", sigma_heading_per_metre, "noise of the heading [deg per m]",
               {0, 90});
  p.add("sigma_heading_per_radian", sigma_heading_per_radian, "noise of the heading [rad per rad]", {0, 1});
  p.add(
      "max_drift", max_drift,
      "localising: drift that two accepted places in a row may differ by, of the way between them [m per m]",
      {0, 10});
  p.add("sigma_floor", sigma_floor, "least standard deviation of an edge [m and rad]", {1e-6, 10});
  p.add("sigma_scale", sigma_scale,
        "error of the wheel radius, one sigma over drives: each drive is one vote on how long a metre is; 0: "
        "the first one says so alone [m per m]",
        {0, 1});
  p.add("max_speed", max_speed, "odometry that is faster is a leap: the way there counts as unknown [m/s]",
        {0.01, 1000});
  p.add("max_acceleration", max_acceleration,
        "odometry that differs from the speed before by more is a leap, too [m/s^2]", {0.01, 1000});
  p.addDegrees("max_turn_rate_deg", max_turn_rate, "and odometry that turns faster [deg/s]", {1, 36000});
}

void MappingParams::describe(base::Params& p) {
  p.addChoice("nodes", nodes,
              "what the nodes of the map are: places, which remember what they were seen to look like; or "
              "views of a stereo camera; or some of these views, as reference scans",
              {"places", "views", "scans"});
}

void ViewParams::describe(base::Params& p) {
  p.add("min_interval", min_interval, "time between two views of the map [s]", {0, 3600});
  p.add("max_features", max_features, "features of a view, the strongest whose range is known", {10, 10000});
  p.add("candidates", candidates, "views of the map that go to geometric verification", {1, 1000});
  p.add("sure_inliers", sure_inliers,
        "inliers of a link that may join parts of the map; one with less must agree with what the graph says",
        {4, 10000});
  p.add("agree_distance", agree_distance, "distance by which a link may differ from the graph [m]", {0, 100});
  p.addDegrees("agree_angle_deg", agree_angle, "angle by which it may [deg]", {0, 180});
  p.add("max_drift", max_drift, "and more on the way since the last link that closed a loop [m per m]",
        {0, 1});
  p.add("max_speed", max_speed, "visual odometry that says the robot is faster has failed [m/s]",
        {0.01, 1000});
  p.add("vocabulary", vocabulary,
        "file of a vocabulary tree, made with `engram-map train-vocabulary`; empty: one is trained on the "
        "views of the map");
  p.add("train_after", train_after,
        "without a file: views from which a tree is trained; till then an image is matched with all",
        {2, 1e6});
  p.add("retrain_growth", retrain_growth,
        "without a file: the tree is trained anew when the map has so many times as many views", {1.1, 1000});
  p.add("wheels", wheels,
        "where visual odometry fails, that of the wheels joins the views; false: a weak link as without "
        "wheels");
  p.add("sigma_floor", sigma_floor, "least standard deviation of a link [m and rad]", {1e-6, 10});
  p.add("weak_sigma", weak_sigma,
        "standard deviation of a weak link, which joins what nothing measured joins [m]", {0.1, 1e6});
  p.add("relax_sigma", relax_sigma,
        "standard deviations by which a new link must differ from the poses to have its surroundings relaxed",
        {0, 1000});
  p.add("relax_all_sigma", relax_all_sigma,
        "standard deviations by which it must differ after that to have the whole map relaxed", {0, 1000});
}

void ScansParams::describe(base::Params& p) {
  scan.describe(p);
  match.describe(p);
  p.add("refine", refine,
        "depths by correlation of the images where that finds them, not by keypoints alone");
  p.add("reach", reach, "distance from a reference scan at which the robot can match it [m]", {0.1, 1000});
  p.add("candidates", candidates, "reference scans near the robot that are matched, nearest first",
        {1, 1000});
  p.add("thin", thin,
        "an image makes the scan before a reference, too, where it matches all others by fewer points than "
        "these and that one by more; 0: only where it matches no other",
        {0, 10000});
  p.add(
      "step", step,
      "without wheels: standard deviation of the motion from one image to the next about the one before [m]",
      {0.001, 100});
  p.addDegrees("turn_deg", turn, "the same of the heading [deg]", {0.01, 180});
}

void PipelineParams::bind(base::Config& config) {
  config.bind("mapping", mapping);
  config.bind("camera", camera);
  config.bind("extractor", extractor);
  config.bind("matching", match);
  config.bind("words", words);
  config.bind("tree", tree);
  config.bind("verify", verify);
  config.bind("stereo", stereo);
  config.bind("visual_odometry", visual_odometry);
  config.bind("select", select);
  config.bind("recognise", recognise);
  config.bind("belief", belief);
  config.bind("appearance", appearance);
  config.bind("place", place);
  config.bind("odometry", odometry);
  config.bind("memory", memory);
  config.bind("fsh", fsh);
  config.bind("multi_store", multi_store);
  config.bind("posegraph", posegraph);
  config.bind("views", views);
  config.bind("scans", scans);
  config.bind("upkeep", upkeep);
}

}  // namespace engram::pipeline
