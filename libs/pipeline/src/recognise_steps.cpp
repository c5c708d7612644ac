// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "recognise_steps.h"

#include "engram/base/parallel.h"
#include "place_rules.h"
#include "step_timer.h"
#include "view_rules.h"

#include <algorithm>

namespace engram::pipeline {

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
  if (!believed(run, image, verified, report) && !similar(run, image, verified, report))
    beside(run, image, verified);
  else if (isClosure(run, verified.accepted->place))
    linkAnchor(run, image, verified);
  return verified;
}

bool OnePlaceStep::believed(Run& run, const Keyframe& image, Verified& verified, types::FrameReport& report) {
  for (auto& hypothesis : candidatesOf(report.hypotheses, run.params.recognise)) {
    if (recogniser_->neighbourhoodMass(hypothesis.place) < run.params.belief.accept_threshold) continue;
    verified.links.push_back(
        {hypothesis.place, recogniser_->match(run.map, image.features, hypothesis.place)});
    const Link& link = verified.links.back();
    hypothesis.inliers = static_cast<int>(link.match.matches.size());
    if (!accepts(run, link)) {
      verified.reason = "the geometry does not confirm the most probable place";
      continue;
    }
    const Link found = link;
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
  if (!best || best->inliers < run.params.recognise.sure_inliers) return false;
  verified.links.push_back({best->place, recogniser_->match(run.map, image.features, best->place)});
  const Link found = verified.links.back();
  if (!accepts(run, found) || ambiguous(run, image, found, verified, report)) return false;
  verified.accepted = found;
  recogniser_->confirm(best->place);
  report.bestGuess = best->place;
  return true;
}

/// The graph may refuse a closure: then the image makes a place beside the last one.
void OnePlaceStep::linkAnchor(Run& run, const Keyframe& image, Verified& verified) {
  const base::PlaceId anchor = run.robot.anchor();
  if (run.robot.frontier())
    verified.links.push_back({anchor, recogniser_->match(run.map, image.features, anchor)});
}

void OnePlaceStep::beside(Run& run, const Keyframe& image, Verified& verified) {
  const base::PlaceId anchor = run.robot.anchor();
  if (!run.robot.frontier() || !anchor.valid()) return;
  const auto nearest = nearestByOdometry(run);
  const base::PlaceId near = nearest ? nearest->first : anchor;
  verified.links.push_back({near, recogniser_->match(run.map, image.features, near)});
  if (accepts(run, verified.links.back()))
    verified.accepted = verified.links.back();
  else if (near != anchor)
    verified.links.push_back({anchor, recogniser_->match(run.map, image.features, anchor)});
}

bool OnePlaceStep::accepts(const Run& run, const Link& link) const {
  if (!strongEnough(link.match, run.params.recognise)) return false;
  return fit_ == Fit::kTerrain ? fitsTerrain(run, link) : fitsWay(run, link);
}

/// Motion has not led the robot there, and the place that looks most like the image among those far from
/// there passes for it too: which of the two it is, only motion can tell. While mapping, two places that
/// nothing has joined yet may be one.
bool OnePlaceStep::ambiguous(Run& run, const Keyframe& image, const Link& link, Verified& verified,
                             types::FrameReport& report) {
  const double share = run.params.recognise.ambiguity;
  if (share <= 0 || (run.robot.anchor().valid() && agreesWithMotion(run, link.place))) return false;
  auto rival = recogniser_->mostSimilar(farFrom(run, link.place));
  if (!rival || (fit_ == Fit::kTerrain && !run.joined(link.place, rival->place))) return false;
  const PlaceMatch& match = recogniser_->match(run.map, image.features, rival->place);
  rival->inliers = static_cast<int>(match.matches.size());
  noteInliers(report.hypotheses, *rival);
  if (!match.verified() || rival->inliers < share * static_cast<double>(link.match.matches.size()))
    return false;
  verified.reason = "ambiguous: places " + std::to_string(link.place.value) + " and " +
                    std::to_string(rival->place.value) + " both explain the image";
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
