// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scan_steps.h"

#include "engram/types/se3.h"
#include "place_rules.h"
#include "place_steps.h"
#include "step_timer.h"
#include "view_rules.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace engram::pipeline {
namespace {

constexpr double kSharp = 1.5, kSharpTurn = 0.35;  // [m], [rad] deviations up to which a pose is linear
constexpr double kDeviations = 3;                  // of a pose, which is added to the reach
constexpr double kOverlap = 0.7;                   // of the field of view that a robot may be turned by
constexpr double kMetresPerRadian = 1;             // a turned reference is farther
constexpr double kCarried = 0.5;                   // [m] between where two images put a robot
/// Errors of neighbouring points, and of one point in several scans, are not independent: on simulated drives
/// the true errors have twice the deviations that the Hessian of the inliers gives, as in visual odometry.
constexpr double kCorrelated = 4;

double positionSigma(const types::RelPose& T) { return std::sqrt(T.cov.diagonal().head<3>().maxCoeff()); }
double headingSigma(const types::RelPose& T) { return std::sqrt(T.cov.diagonal().tail<3>().maxCoeff()); }

double turnOf(const Eigen::Isometry3d& T) { return std::abs(Eigen::AngleAxisd(T.linear()).angle()); }

/// An image held against a scan near where the robot should be, seen from it (V-04 to V-07).
PlaceMatch matchNear(const Run& run, const types::Features& image, const types::Features& scan,
                     const Eigen::Isometry3d& T_scan_robot) {
  const StereoCamera& camera = *run.perception.stereo();
  const Eigen::Isometry3d T_eyes = camera.T_robot_cam.inverse() * T_scan_robot * camera.T_robot_cam;
  const auto matches = odometry::matchScans(scan, image, T_eyes, camera.model, run.params.scans.match);
  const auto found = geometry::verifyStereo(scan, image, matches, camera.model, run.params.stereo);
  PlaceMatch result;
  result.reason = found.reason;
  result.tentative = static_cast<int>(matches.size());
  for (const int i : found.inliers) {
    const types::Match& m = matches[static_cast<std::size_t>(i)];
    result.matches.push_back({m.b, m.a, m.distance});
  }
  if (!found.ok()) return result;
  types::RelPose T = camera.ofRobot(found.T_a_b);
  T.cov *= kCorrelated;
  result.T_place_robot = floored(run, T);
  return result;
}

/// The same by descriptors alone, and again near what they suggest (V-E7).
PlaceMatch matchAnywhere(const Run& run, const types::Features& image, const memory::PlaceMemory& scan) {
  const PlaceMatch found = heldAgainst(image, scan, run.params, run.perception.stereo());
  return found.verified() ? matchNear(run, image, scan.features, found.T_place_robot->T_a_b) : found;
}

bool bySize(const Link& a, const Link& b) { return a.match.matches.size() > b.match.matches.size(); }

Keyframe keyframeOf(const HeldScan& scan) { return {scan.frame, scan.features, scan.picture, {}, 0}; }

}  // namespace

bool ScanTrack::sharp(const Run& run) const {
  if (!poses->begun(run)) return false;
  const auto T = run.robot.motion();
  return !run.robot.anchor().valid() || (T && positionSigma(*T) < kSharp && headingSigma(*T) < kSharpTurn);
}

std::optional<Seen> ScanPerceive::perceive(Run& run, const types::Frame& frame, types::FrameReport& report) {
  const StepTimer timer(report, "perceive");
  report.outcome = types::Outcome::kUnusable;
  report.reason = run.perception.refusal(frame);
  if (!report.reason.empty()) return std::nullopt;
  Seen seen{frame, {}, run.perception.lookWithBothEyes(frame)};
  seen.features = scanOf(run.perception, seen.pair, run.params.scans.scan, run.params.scans.refine);
  report.features = static_cast<int>(seen.features.size());
  if (report.features >= run.params.stereo.min_inliers) return seen;
  report.reason = "too few points that both eyes see";
  return std::nullopt;
}

Evidence NearStep::recognise(Run& run, const Keyframe&, types::FrameReport& report) {
  const StepTimer timer(report, "recognise");
  track_->search.follow(run.map);
  const types::RelPose step = stepOf(run);
  run.robot.mark({}, {.cov = types::Matrix6d::Zero()});
  if (track_->held && track_->poses->begun(run)) track_->poses->step(run, step);
  Evidence evidence;
  if (!track_->sharp(run)) return evidence;
  const ScansParams& params = run.params.scans;
  const types::StereoModel& model = run.perception.stereo()->model;
  const double overlap = kOverlap * 2 * std::atan(model.cx / model.f);
  for (const auto& [id, place] : run.map.places()) {
    const types::RelPose T = track_->poses->expected(run, id);
    const double distance = T.T_a_b.translation().norm(), turn = turnOf(T.T_a_b);
    if (distance > params.reach + kDeviations * positionSigma(T)) continue;
    if (turn > overlap + kDeviations * headingSigma(T)) continue;
    types::Hypothesis near;
    near.place = id;
    near.similarity = 1 / (1 + distance + kMetresPerRadian * turn);
    evidence.hypotheses.push_back(near);
  }
  std::stable_sort(evidence.hypotheses.begin(), evidence.hypotheses.end(),
                   [](const auto& a, const auto& b) { return a.similarity > b.similarity; });
  const auto most = static_cast<std::size_t>(params.candidates);
  evidence.hypotheses.resize(std::min(evidence.hypotheses.size(), most));
  return evidence;
}

/// By the wheels; without them as the step before, give or take.
types::RelPose NearStep::stepOf(const Run& run) {
  const DeadReckoning& wheels = run.robot.sinceMark();
  types::RelPose step = track_->motion;
  const ScansParams& params = run.params.scans;
  step.cov = planarCovariance(params.step, params.step, params.turn, params.turn);
  track_->guessed |= !wheels.anchored();
  track_->lastStep.reset();
  if (wheels.anchored()) {
    const double floor = run.params.odometry.sigma_floor;
    step = wheels.anchorToRobot();
    step.cov += types::Matrix6d::Identity() * floor * floor;
    track_->lastStep = step;
  }
  auto& way = track_->T_made_robot;
  way = way && track_->lastStep ? std::optional(types::compose(*way, step)) : std::nullopt;
  return step;
}

void NearStep::restart() {
  track_->poses->lose();
  track_->held.reset();
  track_->made = {};
}

Verified ScansVerify::verify(Run& run, const Keyframe& image, Evidence evidence, types::FrameReport& report) {
  const StepTimer timer(report, "verify");
  report.hypotheses = std::move(evidence.hypotheses);
  Verified verified;
  const ScanPoses& poses = *track_->poses;
  for (types::Hypothesis& near : report.hypotheses) {
    const types::Features& scan = run.map.place(near.place).memory->features;
    Link link{near.place, matchNear(run, image.features, scan, poses.expected(run, near.place).T_a_b)};
    near.inliers = link.match.verified() ? static_cast<int>(link.match.matches.size()) : 0;
    verified.tried.push_back(near.place);
    if (link.match.verified()) verified.links.push_back(std::move(link));
  }
  if (verified.links.empty()) recover(run, image, verified, report);
  std::stable_sort(verified.links.begin(), verified.links.end(), bySize);
  if (!verified.links.empty()) report.bestGuess = verified.links.front().place;
  if (track_->held && poses.begun(run)) {
    const auto expected = poses.expected(run, {}).T_a_b;
    Link before{{}, matchNear(run, image.features, track_->held->features, expected)};
    if (!before.match.verified() && verified.links.empty())
      before.match = matchAnywhere(run, image.features, memory::Static().start(track_->held->features));
    if (before.match.verified()) verified.previous = std::move(before);
  }
  return verified;
}

/// A link that nothing predicted must be sure.
void ScansVerify::recover(Run& run, const Keyframe& image, Verified& verified,
                          types::FrameReport& report) const {
  for (const auto& [view, score] : track_->search.find(image.features)) {
    types::Hypothesis hypothesis;
    hypothesis.place = view;
    hypothesis.similarity = score;
    Link link{view, matchAnywhere(run, image.features, run.map.place(view).memory)};
    hypothesis.inliers = link.match.verified() ? static_cast<int>(link.match.matches.size()) : 0;
    if (link.match.verified() && isSure(run, link)) verified.links.push_back(std::move(link));
    report.hypotheses.push_back(hypothesis);
  }
}

Decision ScanDecide::decide(Run& run, const Keyframe& image, const Verified& verified,
                            types::FrameReport& report) {
  Decision decision;
  report.outcome = types::Outcome::kRefused;
  if (track_->sharp(run))
    measure(run, image, verified, decision, report);
  else
    begin(run, verified, decision, report);
  if (decision.agreed.empty() && !decision.makesNode) return decision;
  track_->guessed = false;
  report.reason.clear();
  report.outcome = decision.makesNode ? types::Outcome::kNewPlace : types::Outcome::kRecognised;
  if (decision.makesNode) return decision;
  decision.known = decision.agreed.front();
  report.place = decision.known->place;
  return decision;
}

/// A robot that wakes up, or has been lost for long: a sure link says where it is.
void ScanDecide::begin(Run& run, const Verified& verified, Decision& decision,
                       types::FrameReport& report) const {
  report.reason = "not found in the map yet";
  if (run.map.empty()) {
    track_->poses->start(run);
    report.outcome = types::Outcome::kSkipped;
    report.reason = "the first scan";
    return;
  }
  if (verified.links.empty() || !isSure(run, verified.links.front())) return;
  track_->poses->relocate(run, verified.links.front());
  track_->held.reset();
  decision.agreed = {verified.links.front()};
}

void ScanDecide::measure(Run& run, const Keyframe& image, const Verified& verified, Decision& decision,
                         types::FrameReport& report) {
  if (isThin(run, verified)) decision.makesNode = track_->poses->measure(run, *verified.previous);
  for (const Link& link : verified.links) {
    const bool closes = isClosure(run, link.place);
    if (!track_->poses->measure(run, link)) continue;
    report.closure |= closes;
    decision.agreed.push_back(link);
  }
  if (decision.makesNode || !decision.agreed.empty()) return;
  contradict(run, image, verified, decision);
  if (!decision.agreed.empty()) return;
  report.reason = verified.links.empty()
                      ? "matches neither a reference scan nor the scan before"
                      : "the reference scans that it matches contradict where the robot is";
  if (verified.previous) decision.makesNode = track_->poses->measure(run, *verified.previous);
}

/// Whether the scan before would be the better reference. V waits until no reference matches: the last of its
/// matches then hang on few points far away.
bool ScanDecide::isThin(const Run& run, const Verified& verified) {
  const auto size = [](const Link& link) { return static_cast<int>(link.match.matches.size()); };
  const int thin = run.params.scans.thin;
  return !verified.links.empty() && size(verified.links.front()) < thin && verified.previous &&
         size(*verified.previous) >= thin;
}

/// Two sure images in a row that agree with each other, and not with where the robot should be: it was
/// carried. The map learns nothing of it.
void ScanDecide::contradict(Run& run, const Keyframe& image, const Verified& verified, Decision& decision) {
  if (verified.links.empty() || !isSure(run, verified.links.front()) || !run.robot.metric()) return;
  const Link& link = verified.links.front();
  const Eigen::Isometry3d there = run.map.place(link.place).T_map_place * link.match.T_place_robot->T_a_b;
  if (!landings_.agree(image.frame.index, there, T_map_robot(run), kCarried)) return;
  landings_.clear();
  track_->poses->relocate(run, link);
  decision.agreed = {link};
}

base::PlaceId ScanRemember::remember(Run& run, const Keyframe&, const Verified&, const Decision& decision,
                                     types::FrameReport& report) {
  if (!decision.makesNode) return {};
  const StepTimer timer(report, "remember");
  const HeldScan& scan = *track_->held;
  report.place = addNode(run, keyframeOf(scan), types::rigid(track_->poses->T_map_previous(run)),
                         memory_.start(scan.features));
  report.learnt = {report.place};
  return report.place;
}

Relation ScanRelate::relate(Run& run, const Keyframe& image, const Verified& verified,
                            const Decision& decision, base::PlaceId node, types::FrameReport& report) {
  const StepTimer timer(report, "relate");
  Relation relation{.node = node};
  std::vector<Link> links = decision.agreed;
  if (node.valid()) {
    join(run, *track_->held, relation);
    track_->poses->promote(run, node);
    track_->made = node;
    track_->T_made_robot = track_->lastStep;
    links.insert(links.begin(), *verified.previous);
    links.front().place = node;
  }
  const base::PlaceId anchor = run.robot.anchor();
  if (anchor.valid() && run.robot.metric())
    run.map.addPathPoint({run.session, image.frame.stamp, anchor, types::rigid(run.robot.motion()->T_a_b)});
  hold(run, image, std::move(links));
  return relation;
}

void ScanRelate::join(Run& run, const HeldScan& scan, Relation& relation) const {
  std::vector<map::Edge> edges;
  for (const Link& link : scan.links) {
    const bool thin = static_cast<int>(link.match.matches.size()) < run.params.scans.thin;
    if (thin && !edges.empty()) break;  // they come by their size
    edges.push_back(edgeOf(run, link, relation.node));
    const auto near = run.map.hopDistances(scan.links.front().place, run.params.place.recent_hops);
    if (near.contains(link.place)) edges.back().type = map::EdgeType::kOdometry;
  }
  if (edges.empty() && scan.anchor.valid() && !(scan.T_made_scan && scan.anchor == track_->made)) {
    map::Edge way{.type = map::EdgeType::kOdometry, .a = scan.anchor, .b = relation.node};
    way.T_a_b = floored(run, scan.T_anchor_scan);
    if (scan.guessed) {
      const double sigma = run.params.views.weak_sigma;
      way.type = map::EdgeType::kWeak;
      way.T_a_b.cov = types::Matrix6d::Identity() * sigma * sigma;
    }
    edges.push_back(std::move(way));
  }
  if (track_->made.valid() && scan.T_made_scan)
    edges.push_back({.type = map::EdgeType::kOdometry,
                     .a = track_->made,
                     .b = relation.node,
                     .T_a_b = *scan.T_made_scan});
  for (map::Edge& edge : edges) relation.edges.push_back(run.map.addEdge(std::move(edge)));
}

/// The image is the scan before for the next one.
void ScanRelate::hold(const Run& run, const Keyframe& image, std::vector<Link> links) const {
  const bool begun = track_->poses->begun(run);
  if (track_->held && !links.empty() && track_->held->anchor.valid() && run.robot.metric()) {
    const HeldScan& before = *track_->held;
    const Eigen::Isometry3d T_map_before =
        run.map.place(before.anchor).T_map_place * before.T_anchor_scan.T_a_b;
    track_->motion.T_a_b = T_map_before.inverse() * T_map_robot(run);
  }
  HeldScan scan{.frame = image.frame,
                .features = image.features,
                .picture = image.picture,
                .links = std::move(links),
                .anchor = run.robot.anchor(),
                .T_anchor_scan = run.robot.motion().value_or(types::RelPose{}),
                .guessed = track_->guessed,
                .T_made_scan = track_->T_made_robot};
  track_->held.reset();
  if (begun) track_->held = std::move(scan);
}

void ScanRelax::relax(Run& run, const Relation& relation, types::FrameReport& report) {
  const StepTimer timer(report, "relax");
  track_->poses->settle(run, relation.node);
}

}  // namespace engram::pipeline
