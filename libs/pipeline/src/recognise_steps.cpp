// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "recognise_steps.h"

#include "engram/base/parallel.h"
#include "engram/pipeline/place_fix.h"
#include "place_rules.h"
#include "step_timer.h"
#include "view_rules.h"

#include <algorithm>
#include <utility>

namespace engram::pipeline {
namespace {

/// Matches of one thing are less spread than this share of all features of the view.
constexpr double kOneThing = 0.5;
/// A place met again in one drive has this share of the matches that the place just left has, at least.
constexpr double kMetAgain = 0.5;
/// Places looked at beside the one where the robot is: an image is one witness.
constexpr std::size_t kEchoes = 1;

}  // namespace

Evidence BeliefStep::recognise(Run& run, const Keyframe& image, types::FrameReport& report) {
  const StepTimer timer(report, "recognise");
  const auto excluded = run.robot.frontier() ? run.robot.recent() : std::set<base::PlaceId>{};
  Evidence evidence{recogniser_->recognise(run.map, image.features, image.travel, excluded, image.picture)};
  if (!evidence.hypotheses.empty()) report.bestGuess = evidence.hypotheses.front().place;
  report.bestGuessInterpolated = recogniser_->interpolatedPeak();
  report.newPlaceProbability = recogniser_->newPlaceProbability();
  return evidence;
}

Evidence IndexStep::recognise(Run& run, const Keyframe& image, types::FrameReport& report) {
  const StepTimer timer(report, "recognise");
  search_.follow(run.map);
  Evidence evidence;
  for (const auto& [view, score] : search_.find(image.features)) {
    types::Hypothesis hypothesis;
    hypothesis.place = view;
    hypothesis.similarity = score;
    evidence.hypotheses.push_back(hypothesis);
  }
  return evidence;
}

Verified OnePlaceStep::verify(Run& run, const Keyframe& image, Evidence evidence,
                              types::FrameReport& report) {
  const StepTimer timer(report, "verify");
  report.hypotheses = std::move(evidence.hypotheses);
  Verified verified;
  verified.reason = "no place is probable enough";
  if (!expected(run, image, verified, report) && !sameSpot(run, image, verified, report) &&
      !believed(run, image, verified, report) && !similar(run, image, verified, report))
    beside(run, image, verified);
  else if (isClosure(run, verified.accepted->place))
    linkAnchor(run, image, verified);
  if (fit_ == Fit::kTerrain) findEchoes(run, image, verified);
  if (fit_ == Fit::kWay && !verified.accepted) verified.bySequence = bySequence(run, verified);
  return verified;
}

/// In known ground the place where odometry puts the robot is asked first: another one that looks like the
/// image may show it from afar, and measures the pose the worse.
bool OnePlaceStep::expected(Run& run, const Keyframe& image, Verified& verified, types::FrameReport& report) {
  if (run.robot.frontier()) return false;
  const auto nearest = nearestByOdometry(run);
  if (!nearest || nearest->second >= spacingHere(run)) return false;
  Link link{nearest->first, recogniser_->match(run.map, image.features, nearest->first)};
  if (withOdometry(run, link) != Agreement::kAgrees || !strongEnough(link.match, run.params.recognise))
    return false;
  if (!accepts(run, image, link, verified)) return false;
  verified.links.push_back(link);
  verified.accepted = link;
  if (run.map.hopDistances(link.place, 1).contains(report.bestGuess)) return true;
  recogniser_->confirm(link.place);
  report.bestGuess = link.place;
  report.bestGuessInterpolated = -1;
  return true;
}

/// Without odometry on new ground, where the belief leaves out the places just made: a robot that rocks or
/// turns back is at one of them when nothing but a rotation lies between.
bool OnePlaceStep::sameSpot(Run& run, const Keyframe& image, Verified& verified, types::FrameReport& report) {
  if (fit_ != Fit::kTerrain || !run.robot.frontier() || run.robot.metric()) return false;
  std::optional<Link> best;
  for (const base::PlaceId place : run.robot.recent()) {
    const PlaceMatch& match = recogniser_->match(run.map, image.features, place);
    if (!match.direction_place.isZero() || match.similarity < kSameSpot) continue;
    if (!strongEnough(match, run.params.recognise)) continue;
    if (!best || match.matches.size() > best->match.matches.size()) best = Link{place, match};
  }
  if (!best) return false;
  verified.links.push_back(*best);
  verified.accepted = best;
  recogniser_->confirm(best->place);
  report.bestGuess = best->place;
  return true;
}

bool OnePlaceStep::believed(Run& run, const Keyframe& image, Verified& verified, types::FrameReport& report) {
  for (auto& hypothesis : candidatesOf(report.hypotheses, run.params.recognise)) {
    if (recogniser_->neighbourhoodMass(hypothesis.place) < run.params.belief.accept_threshold) continue;
    verified.links.push_back(
        {hypothesis.place, recogniser_->match(run.map, image.features, hypothesis.place)});
    Link found = verified.links.back();
    hypothesis.inliers = static_cast<int>(found.match.matches.size());
    if (!accepts(run, image, found, verified)) {
      verified.reason = "the geometry does not confirm the most probable place";
      continue;
    }
    if (ambiguous(run, image, found, verified, report)) return false;
    verified.accepted = found;
    return true;
  }
  return false;
}

/// The best verified of the most similar places, while the belief is undecided: as many matches as K-15 asks
/// need none (K-21).
bool OnePlaceStep::similar(Run& run, const Keyframe& image, Verified& verified, types::FrameReport& report) {
  if (run.params.recognise.sure_inliers <= 0) return false;
  std::optional<types::Hypothesis> best;
  for (auto& hypothesis : recogniser_->mostSimilar()) {
    const PlaceMatch& match = recogniser_->match(run.map, image.features, hypothesis.place);
    hypothesis.inliers = static_cast<int>(match.matches.size());
    noteInliers(report.hypotheses, hypothesis);
    if (match.verified() && hypothesis.inliers > (best ? best->inliers : 0)) best = hypothesis;
  }
  // What is wrong while mapping stays in the map.
  const auto& params = run.params.recognise;
  const int enough =
      fit_ == Fit::kWay ? params.sure_inliers : std::max(params.sure_inliers, params.closure_inliers);
  if (!best || best->inliers < enough) return false;
  verified.links.push_back({best->place, recogniser_->match(run.map, image.features, best->place)});
  Link found = verified.links.back();
  if (!accepts(run, image, found, verified) || ambiguous(run, image, found, verified, report)) return false;
  verified.accepted = found;
  recogniser_->confirm(best->place);
  report.bestGuess = best->place;
  return true;
}

/// Images that have too few matches each may say together where the robot is. The way it came must allow it,
/// and no view verify elsewhere.
base::PlaceId OnePlaceStep::bySequence(const Run& run, const Verified& verified) const {
  const auto place = recogniser_->bySequence();
  if (!place || !agreesWithMotion(run, *place)) return {};
  const auto near = run.map.hopDistances(*place, run.params.belief.accept_hops);
  const bool denied = std::any_of(verified.links.begin(), verified.links.end(), [&](const Link& link) {
    return !near.contains(link.place) && strongEnough(link.match, run.params.recognise);
  });
  return denied ? base::PlaceId() : *place;
}

/// The graph may refuse a closure: then the image makes a place beside the last one.
void OnePlaceStep::linkAnchor(Run& run, const Keyframe& image, Verified& verified) {
  const base::PlaceId anchor = run.robot.anchor();
  if (run.robot.frontier())
    verified.links.push_back({anchor, recogniser_->match(run.map, image.features, anchor)});
}

/// The belief that knows where the robot is asks for no other place: nothing would ever close a loop that the
/// map has missed once. And one that is not sure yet lets witnesses pass that the graph could use.
void OnePlaceStep::findEchoes(Run& run, const Keyframe& image, Verified& verified) {
  if (!run.robot.metric()) return;
  const base::PlaceId here = verified.accepted ? verified.accepted->place : run.robot.anchor();
  if (isClosure(run, here)) return;
  const auto& params = run.params.recognise;
  const auto near = run.map.hopDistances(here, run.params.place.recent_hops);
  const auto others = recogniser_->mostSimilar(kEchoes, [&](base::PlaceId id) { return !near.contains(id); });
  for (const types::Hypothesis& other : others) {
    if (other.similarity < params.closure_similarity) break;
    if (run.closures.count(here, other.place) >= run.params.posegraph.gate.gate_support) continue;
    if (!run.joined(here, other.place)) continue;
    const PlaceMatch& match = recogniser_->match(run.map, image.features, other.place);
    const Link echo{other.place, match};
    const bool strong = static_cast<int>(match.matches.size()) >= closureInliers(run, echo);
    if (strong && match.length && match.spread >= kOneThing && strongEnough(match, params))
      verified.echoes.push_back(echo);
  }
}

/// Where odometry puts the robot is asked last, whatever the belief says; on new ground the place just made,
/// too, which a new one is joined to.
void OnePlaceStep::beside(Run& run, const Keyframe& image, Verified& verified) {
  const base::PlaceId anchor = run.robot.anchor();
  const auto nearest = nearestByOdometry(run);
  if (!anchor.valid() || (!run.robot.frontier() && !nearest)) return;
  const base::PlaceId near = nearest ? nearest->first : anchor;
  verified.links.push_back({near, recogniser_->match(run.map, image.features, near)});
  Link found = verified.links.back();
  if (accepts(run, image, found, verified))
    verified.accepted = found;
  else if (near != anchor && run.robot.frontier())
    verified.links.push_back({anchor, recogniser_->match(run.map, image.features, anchor)});
}

/// The way that odometry expects is evidence, too: a view that agrees with it needs less of its own, and one
/// that contradicts it needs as much as a loop closure, or another that says the same. Without it, matches
/// that lie together in the view may be those of one thing that was carried elsewhere.
bool OnePlaceStep::accepts(Run& run, const Keyframe& image, Link& link, Verified& verified) {
  if (!link.match.verified()) return false;
  const Agreement agreement = withOdometry(run, link);
  const auto& params = run.params.recognise;
  if (agreement == Agreement::kUnknown && link.match.spread < kOneThing) return false;
  if (agreement != Agreement::kAgrees && !strongEnough(link.match, params)) return false;
  if (agreement == Agreement::kAgrees) contradictions_.clear();
  if (agreement == Agreement::kContradicts) {
    const auto measured = measuredBy(link.match, run.perception.eye());
    link.overrules =
        measured &&
        contradictions_.agree(image.frame.index, run.map.place(link.place).T_map_place * measured->T_a_b,
                              T_map_robot(run), 0.5 * run.params.place.spacing);
    if (link.overrules) return true;
    verified.doubtful = true;
    if (static_cast<int>(link.match.matches.size()) < params.closure_inliers) return false;
  }
  return fit_ == Fit::kWay ? fitsWay(run, link) : fitsTerrain(run, link) && mayJoin(run, image, link);
}

/// Nothing can deny the closure that joins two parts of a map, and all that is mapped hangs on it. Where
/// places know how far their features are it takes two images whose poses agree with the way between them.
bool OnePlaceStep::mayJoin(Run& run, const Keyframe& image, const Link& link) {
  if (!run.robot.metric() || run.joined(run.robot.anchor(), link.place)) return true;
  const auto measured = measuredBy(link.match, run.perception.eye());
  if (!measured) return run.map.place(link.place).memory.features.ranges.empty();
  return joins_.agree(image.frame.index, run.map.place(link.place).T_map_place * measured->T_a_b,
                      T_map_robot(run), 0.5 * run.params.place.spacing);
}

/// Without odometry nothing denies a closure to another storey that looks alike, before this one is mapped.
/// But under the same light a place met again shows about as much of the image as the one just left does,
/// and what has only its signs and doors in common shows less.
bool OnePlaceStep::lessThanTheLast(Run& run, const Keyframe& image, const Link& link) {
  const base::PlaceId anchor = run.robot.anchor();
  if (fit_ != Fit::kTerrain || run.robot.metric() || !run.robot.frontier() || !anchor.valid()) return false;
  if (!isClosure(run, link.place) || run.map.place(link.place).session != run.session) return false;
  const PlaceMatch& last = recogniser_->match(run.map, image.features, anchor);
  return static_cast<double>(link.match.matches.size()) <
         kMetAgain * static_cast<double>(last.matches.size());
}

/// Motion has not led the robot there, and the place that looks most like the image among those far from
/// there passes for it too: which of the two it is, only motion can tell. While mapping, two places that
/// nothing has joined yet may be one.
bool OnePlaceStep::ambiguous(Run& run, const Keyframe& image, const Link& link, Verified& verified,
                             types::FrameReport& report) {
  const double share = run.params.recognise.ambiguity;
  if (share > 0 && lessThanTheLast(run, image, link)) {
    report.rival = run.robot.anchor();
    verified.reason = "ambiguous: place " + std::to_string(link.place.value) +
                      " explains much less of the image than place " + std::to_string(report.rival.value) +
                      ", which the robot has just left";
    return true;
  }
  if (share <= 0 || (run.robot.anchor().valid() && agreesWithMotion(run, link.place))) return false;
  auto rivals = recogniser_->mostSimilar(1, farFrom(run, link.place));
  if (rivals.empty()) return false;
  types::Hypothesis& rival = rivals.front();
  if (fit_ == Fit::kTerrain && !run.joined(link.place, rival.place)) return false;
  const PlaceMatch& match = recogniser_->match(run.map, image.features, rival.place);
  rival.inliers = static_cast<int>(match.matches.size());
  noteInliers(report.hypotheses, rival);
  if (!match.verified() || rival.inliers < share * static_cast<double>(link.match.matches.size()))
    return false;
  if (run.joined(link.place, rival.place) && onePose(run, link, {rival.place, match})) return false;
  report.rival = rival.place;
  verified.reason = "ambiguous: places " + std::to_string(link.place.value) + " and " +
                    std::to_string(rival.place.value) + " both explain the image";
  return true;
}

Verified AllViewsStep::verify(Run& run, const Keyframe& image, Evidence evidence,
                              types::FrameReport& report) {
  const StepTimer timer(report, "verify");
  Verified verified;
  report.hypotheses = std::move(evidence.hypotheses);
  for (const auto& hypothesis : report.hypotheses) verified.tried.push_back(hypothesis.place);
  const base::PlaceId anchor = run.robot.anchor();
  const auto& tried = verified.tried;
  if (run.robot.metric() && std::find(tried.begin(), tried.end(), anchor) == tried.end())
    verified.tried.push_back(anchor);
  std::vector<std::optional<Link>> links(tried.size());
  base::parallelFor(links.size(), run.params.recognise.threads,
                    [&](std::size_t i) { links[i] = linkTo(run, image.features, tried[i]); });
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (i < report.hypotheses.size())
      report.hypotheses[i].inliers = links[i] ? static_cast<int>(links[i]->match.matches.size()) : 0;
    if (links[i]) verified.links.push_back(std::move(*links[i]));
  }
  std::stable_sort(verified.links.begin(), verified.links.end(), [](const Link& a, const Link& b) {
    return a.match.matches.size() > b.match.matches.size();
  });
  if (!verified.links.empty()) report.bestGuess = verified.links.front().place;
  return verified;
}

}  // namespace engram::pipeline
