// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/recogniser.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace engram::pipeline {

namespace {

/// While mapping, what places share is known of one building. In a finished map, which may be of any, the
/// similarity only tells evidence from noise.
belief::BeliefParams paramsFor(Recogniser::Mode mode, const PipelineParams& params) {
  belief::BeliefParams belief = params.belief;
  if (mode == Recogniser::Mode::kMapping) belief.new_place_similarity = params.recognise.closure_similarity;
  return belief;
}

/// Half of the trust until the two channels are known to agree.
constexpr double kFirstTrust = 0.5;

constexpr std::size_t kLikely = 20;  // places where the robot may be that are looked at in any case,
constexpr double kStandsOut = 2;     // those that are so many times as likely as the average

/// Indices of the largest values that may be, in order; of equal ones the earlier.
template <class MayBe>
std::vector<std::size_t> largest(const std::vector<double>& values, std::size_t most, const MayBe& mayBe) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (found.size() == most && (most == 0 || !(values[i] > values[found.back()]))) continue;
    if (!mayBe(i)) continue;
    if (found.size() == most) found.pop_back();
    found.insert(std::upper_bound(found.begin(), found.end(), values[i],
                                  [&](double value, std::size_t j) { return value > values[j]; }),
                 i);
  }
  return found;
}

belief::BeliefParams wholeImageParams(const PipelineParams& params) {
  belief::BeliefParams belief = params.belief;
  belief.likelihood = "standardised";
  belief.evidence = params.appearance.evidence;
  belief.new_place_similarity = params.appearance.usual_similarity;
  belief.sigma_z = 0;
  belief.sigma_z_min = params.appearance.least_spread;
  return belief;
}

}  // namespace

Recogniser::Recogniser(const PipelineParams& params, Mode mode, std::optional<StereoCamera> stereo,
                       std::unique_ptr<appearance::Describer> describer)
    : params_(params.recognise),
      mode_(mode),
      matching_(params.match),
      verify_(params.verify),
      stereoVerify_(params.stereo),
      stereo_(std::move(stereo)),
      scorer_(makeScorer(params)),
      usualSpacing_(params.place.spacing),
      spacing_(params.place.spacing),
      filter_(paramsFor(mode, params), mode == Mode::kMapping),
      byFeatures_(filter_.params(), 1.0),
      byWhole_(wholeImageParams(params), kFirstTrust) {
  if (describer) wholeImage_.emplace(std::move(describer));
  filter_.reset(0);
}

void Recogniser::restart() {
  filter_.reset(ids_.size());
  byFeatures_.reset();
  byWhole_.reset();
}

void Recogniser::load(const map::TopologicalMap& map) {
  if (wholeImage_) wholeImage_->restore(map);
  for (const auto& [id, place] : map.places()) numberOf(map, id);
  if (wholeImage_) wholeImage_->forgetRestored();
  scorer_->load(map, ids_);
  std::set<int> touched;
  for (const auto& [id, edge] : map.edges()) edgeChanged(edge, touched);
  for (const int index : touched) connect(map, index);
  for (const auto& [id, place] : map.places()) placeMoved(place);
  read_ = map.now();
  restart();
}

void Recogniser::follow(const map::TopologicalMap& map) {
  const map::MapChanges changes = map.changesSince(read_);
  for (const auto id : changes.memories) placeChanged(map, map.place(id));
  filter_.grow(ids_.size(), 0.0);
  scorer_->settled(map);
  std::set<int> touched;
  for (const auto id : changes.removedEdges) edgeRemoved(id, touched);
  for (const auto id : changes.edges) edgeChanged(map.edge(id), touched);
  for (const int index : touched) connect(map, index);
  for (const auto id : changes.places) placeMoved(map.place(id));
}

int Recogniser::indexOf(base::PlaceId id) const {
  const auto at = std::lower_bound(ids_.begin(), ids_.end(), id);
  return at != ids_.end() && *at == id ? static_cast<int>(at - ids_.begin()) : -1;
}

/// Of a new place too: ids only grow.
int Recogniser::numberOf(const map::TopologicalMap& map, base::PlaceId place) {
  if (const int known = indexOf(place); known >= 0) return known;
  ids_.push_back(place);
  adjacency_.neighbours.emplace_back();
  adjacency_.successor.push_back(-1);
  adjacency_.predecessor.push_back(-1);
  adjacency_.poses.emplace_back();
  if (wholeImage_) wholeImage_->add(map, place, ids_.size() - 1);
  return static_cast<int>(ids_.size()) - 1;
}

void Recogniser::placeChanged(const map::TopologicalMap& map, const map::Place& place) {
  scorer_->placeChanged(static_cast<std::size_t>(numberOf(map, place.id)), place);
}

std::vector<map::DerivedRow> Recogniser::derived(const map::TopologicalMap& map) {
  follow(map);
  std::vector<map::DerivedRow> rows = scorer_->changes();
  if (wholeImage_)
    for (map::DerivedRow& row : wholeImage_->changes()) rows.push_back(std::move(row));
  return rows;
}

void Recogniser::edgeChanged(const map::Edge& edge, std::set<int>& touched) {
  if (!map::isPassage(edge.type)) return;
  Passage passage{indexOf(edge.a), indexOf(edge.b), edge.type == map::EdgeType::kOdometry, 0};
  if (passage.counts) passage.length = std::llround(1e9 * edge.T_a_b.T_a_b.translation().norm());
  if (!passages_.try_emplace(edge.id, passage).second) return;  // its features have changed alone
  count(passage, 1);
  touched.insert({passage.a, passage.b});
}

void Recogniser::edgeRemoved(base::EdgeId id, std::set<int>& touched) {
  const auto gone = passages_.extract(id);
  if (!gone) return;
  count(gone.mapped(), -1);
  touched.insert({gone.mapped().a, gone.mapped().b});
}

void Recogniser::count(const Passage& passage, int sign) {
  if (!passage.counts) return;
  counted_ += sign * passage.length;
  steps_ += sign;
  spacing_ =
      counted_ > 0 ? 1e-9 * static_cast<double>(counted_) / static_cast<double>(steps_) : usualSpacing_;
}

/// The neighbours of a place anew, and its place in the chain.
void Recogniser::connect(const map::TopologicalMap& map, int index) {
  const auto at = static_cast<std::size_t>(index);
  std::set<int> neighbours;
  if (map.places().contains(ids_[at]))
    for (const map::Neighbour& n : map.neighbours(ids_[at]))
      if (map::isPassage(n.type)) neighbours.insert(indexOf(n.place));
  adjacency_.neighbours[at].assign(neighbours.begin(), neighbours.end());
  adjacency_.successor[at] = neighbours.contains(index + 1) ? index + 1 : -1;
  adjacency_.predecessor[at] = neighbours.contains(index - 1) ? index - 1 : -1;
}

void Recogniser::placeMoved(const map::Place& place) {
  const Eigen::Isometry3d& T = place.T_map_place;
  adjacency_.poses[static_cast<std::size_t>(indexOf(place.id))] = {T(0, 3), T(1, 3),
                                                                   std::atan2(T(1, 0), T(0, 0))};
}

std::vector<double> Recogniser::similarities(const types::Features& view) const {
  return scorer_->scores(view);
}

std::vector<types::Hypothesis> Recogniser::recognise(const map::TopologicalMap& map,
                                                     const types::Features& view,
                                                     const std::optional<Travel>& travel,
                                                     const std::set<base::PlaceId>& excluded,
                                                     const cv::Mat& picture) {
  follow(map);
  matches_.clear();
  if (ids_.empty()) return {};
  predict(travel);
  std::vector<double> scores = scorer_->scores(view, likely());
  if (params_.verified_scores > 0) scores = verifiedScores(map, view, scores, excluded);
  const bool looks = wholeImage_ && !picture.empty();
  return weighPredicted(scores, travel.has_value(), excluded,
                        looks ? wholeImage_->similarities(picture) : std::vector<double>{});
}

void Recogniser::predict(const std::optional<Travel>& travel) {
  belief::MotionHint hint;
  if (travel) {
    hint.hops = travel->distance / spacing_;
    hint.odometry = belief::OdometryStep{travel->step, travel->heading, spacing_};
  }
  filter_.predict(adjacency_, hint);
}

/// Where the robot is believed to be before it has looked: an index that misses these places loses a robot
/// that knows where it is.
std::vector<std::size_t> Recogniser::likely() const {
  const std::vector<double>& believed = filter_.posterior().places;
  std::vector<std::size_t> found = largest(believed, kLikely, [](std::size_t) { return true; });
  const double usual = kStandsOut / static_cast<double>(believed.size());
  std::erase_if(found, [&](std::size_t i) { return believed[i] < usual; });
  return found;
}

const PlaceMatch& Recogniser::match(const map::TopologicalMap& map, const types::Features& view,
                                    base::PlaceId place) {
  const auto [at, isNew] = matches_.try_emplace(place);
  if (isNew) at->second = held(view, map.place(place).memory);
  return at->second;
}

PlaceMatch Recogniser::held(const types::Features& view, const memory::PlaceMemory& place) const {
  return stereo_ ? matchToPlace(view, place, matching_, stereoVerify_, *stereo_)
                 : matchToPlace(view, place, matching_, verify_);
}

/// F eq (8) with match() as F-06 has it, geometry included, for the places that descriptors put first.
std::vector<double> Recogniser::verifiedScores(const map::TopologicalMap& map, const types::Features& view,
                                               const std::vector<double>& scores,
                                               const std::set<base::PlaceId>& excluded) {
  std::vector<double> verified(scores.size(), 0.0);
  for (const std::size_t i :
       largest(scores, static_cast<std::size_t>(params_.verified_scores), notOf(excluded)))
    verified[i] = match(map, view, ids_[i]).similarity;
  return verified;
}

std::vector<types::Hypothesis> Recogniser::weigh(const std::vector<double>& scores,
                                                 const std::optional<Travel>& travel,
                                                 const std::set<base::PlaceId>& excluded,
                                                 const std::vector<double>& whole) {
  if (ids_.empty()) return {};
  predict(travel);
  return weighPredicted(scores, travel.has_value(), excluded, whole);
}

std::vector<types::Hypothesis> Recogniser::weighPredicted(const std::vector<double>& scores, bool travelled,
                                                          const std::set<base::PlaceId>& excluded,
                                                          const std::vector<double>& whole) {
  // Odometry tells whether the robot is on new ground; without it the image has to.
  std::optional<double> newPlace;
  if (mode_ == Mode::kMapping && !travelled) newPlace = params_.closure_similarity;
  update(likelihoodWithout(excluded, scores, byFeatures_, newPlace), excluded, whole);
  if (mode_ == Mode::kLocalisation) {
    byFeatures_.watch(scores);
    if (!whole.empty()) byWhole_.watch(whole);
  }

  lastScores_ = scores;
  for (const auto id : excluded) lastScores_[static_cast<std::size_t>(indexOf(id))] = 0.0;
  const auto most = static_cast<std::size_t>(std::max(params_.candidates, params_.reported));
  std::vector<types::Hypothesis> hypotheses;
  for (const std::size_t i : largest(filter_.posterior().places, most, notOf(excluded)))
    hypotheses.push_back(hypothesis(i));
  return hypotheses;
}

/// With both channels each learns how far it is trusted from what they believe together.
void Recogniser::update(const belief::Likelihood& features, const std::set<base::PlaceId>& excluded,
                        const std::vector<double>& whole) {
  filter_.update(features);
  if (whole.empty()) return;
  const belief::Likelihood likelihood = likelihoodWithout(excluded, whole, byWhole_);
  filter_.update(likelihood);
  byFeatures_.learn(features, filter_.posterior());
  byWhole_.learn(likelihood, filter_.posterior());
}

types::Hypothesis Recogniser::hypothesis(std::size_t i) const {
  return {ids_[i], lastScores_[i], filter_.posterior().places[i], -1};
}

std::vector<types::Hypothesis> Recogniser::mostSimilar() const {
  return mostSimilar(static_cast<std::size_t>(params_.candidates), [](base::PlaceId) { return true; });
}

std::vector<types::Hypothesis> Recogniser::mostSimilar(
    std::size_t most, const std::function<bool(base::PlaceId)>& mayBe) const {
  const auto similar = [&](std::size_t i) { return lastScores_[i] > 0 && mayBe(ids_[i]); };
  std::vector<types::Hypothesis> found;
  for (const std::size_t i : largest(lastScores_, most, similar)) found.push_back(hypothesis(i));
  return found;
}

void Recogniser::confirm(base::PlaceId place) {
  std::vector<double> found(ids_.size(), 0.0);
  found[static_cast<std::size_t>(indexOf(place))] = 1.0;
  filter_.update(belief::likelihood(found, adjacency_, filter_.params()));
}

/// Places just made look like the image without being the answer: the new-place state stands for them. For
/// the statistics over the map they count as one more ordinary place.
belief::Likelihood Recogniser::likelihoodWithout(const std::set<base::PlaceId>& excluded,
                                                 std::vector<double> scores, const belief::Channel& channel,
                                                 std::optional<double> newPlace) const {
  double sum = std::accumulate(scores.begin(), scores.end(), 0.0);
  for (const auto id : excluded) sum -= scores[static_cast<std::size_t>(indexOf(id))];
  const auto others = static_cast<double>(scores.size() - excluded.size());
  for (const auto id : excluded)
    scores[static_cast<std::size_t>(indexOf(id))] = others > 0 ? std::clamp(sum / others, 0.0, 1.0) : 0.0;
  belief::Likelihood result = channel.likelihood(scores, adjacency_, newPlace);
  for (const auto id : excluded) result.places[static_cast<std::size_t>(indexOf(id))] = result.floor;
  return result;
}

double Recogniser::neighbourhoodMass(base::PlaceId place) const {
  return filter_.neighbourhoodMass(adjacency_, indexOf(place), filter_.params().accept_hops);
}

double Recogniser::interpolatedPeak() const {
  const int best = filter_.best();
  return best < 0 ? -1.0 : filter_.interpolatedPeak(adjacency_, best);
}

}  // namespace engram::pipeline
