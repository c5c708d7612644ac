// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/contender.h"

#include "engram/memory/static_view.h"
#include "engram/pipeline/pipeline.h"
#include "engram/pipeline/place_match.h"
#include "engram/store/feature_file.h"
#include "engram/vocabulary/bag_of_words.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace engram::apps {
namespace {

constexpr double kEdgeSigma = 0.1;  // [m] and [rad]; only the presence of an edge matters here

void addEdge(map::TopologicalMap& map, int a, int b, map::EdgeType type) {
  const base::PlaceId from(static_cast<std::uint32_t>(a)), to(static_cast<std::uint32_t>(b));
  map::Edge edge;
  edge.type = type;
  edge.a = from;
  edge.b = to;
  edge.T_a_b.T_a_b = map.place(from).T_map_place.inverse() * map.place(to).T_map_place;
  edge.T_a_b.cov = types::Matrix6d::Identity() * (kEdgeSigma * kEdgeSigma);
  map.addEdge(std::move(edge));
}

map::TopologicalMap makeMap(const memory::MemoryModel& model, const std::vector<LearnView>& tour,
                            const std::vector<Eigen::Isometry3d>& T_map_robot, bool closed) {
  map::TopologicalMap map;
  for (std::size_t i = 0; i < tour.size(); ++i) {
    map::Place place;
    place.T_map_place = T_map_robot[i];
    place.memory = model.start(tour[i].features);
    place.createdStamp = tour[i].frame.stamp;
    place.createdIndex = i;
    map.addPlace(std::move(place));
    const int n = static_cast<int>(i);
    if (i > 0) addEdge(map, n - 1, n, map::EdgeType::kOdometry);
  }
  if (closed && tour.size() > 2) addEdge(map, static_cast<int>(tour.size()) - 1, 0, map::EdgeType::kLoop);
  return map;
}

/// A memory model behind the localiser of the product.
class MemoryContender : public Contender {
 public:
  MemoryContender(const pipeline::PipelineParams& params, map::TopologicalMap map)
      : params_(params), map_(std::move(map)), recogniser_(fresh()) {}

  Learning learn(const std::vector<LearnView>& drive, const Verdict& isRight) override {
    pipeline::Pipeline localizer(params_, std::move(map_),
                                 pipeline::Use::kAdapting);  // a new drive: it may start anywhere
    Learning result;
    for (std::size_t i = 0; i < drive.size(); ++i) {
      const types::FrameReport report = localizer.process(drive[i].frame, drive[i].features);
      ++result.views;
      if (report.outcome != types::Outcome::kRecognised) continue;
      ++result.accepted;
      result.wrong += !isRight(i, report.place);
      result.learnt += static_cast<int>(report.learnt.size());
    }
    result.learnt += static_cast<int>(localizer.finish().size());
    map_ = std::move(localizer).release();
    recogniser_ = fresh();
    return result;
  }

  std::vector<double> scores(const types::Features& view) const override {
    return recogniser_.similarities(view);
  }

  Holdings holdings() const override {
    std::vector<const memory::PlaceMemory*> memories;
    for (const auto& [id, place] : map_.places()) memories.push_back(&*place.memory);
    return holdingsOf(memories);
  }

  const map::TopologicalMap& map() const override { return map_; }

 private:
  pipeline::Recogniser fresh() const {
    pipeline::Recogniser recogniser(params_, pipeline::Recogniser::Mode::kLocalisation);
    recogniser.load(map_);
    return recogniser;
  }

  pipeline::PipelineParams params_;
  map::TopologicalMap map_;
  pipeline::Recogniser recogniser_;
};

/// The bag of words of F-27: every view is kept, the dictionary is rebuilt after each drive, and the best
/// places by tf-idf must pass the same geometric check (F-27b).
class BagContender : public Contender {
 public:
  BagContender(const Method& method, map::TopologicalMap map, const std::vector<LearnView>& tour)
      : params_(method.params), map_(std::move(map)), bag_(bowParams(method.words)) {
    for (std::size_t i = 0; i < tour.size(); ++i)
      views_.push_back({base::PlaceId(static_cast<std::uint32_t>(i)), whole_.start(tour[i].features)});
    rebuild();
  }

  Learning learn(const std::vector<LearnView>& drive, const Verdict& isRight) override {
    pipeline::Recogniser filter(params_, pipeline::Recogniser::Mode::kLocalisation);
    filter.load(map_);
    Learning result;
    std::vector<Stored> added;
    for (std::size_t i = 0; i < drive.size(); ++i) {
      ++result.views;
      const auto hypotheses = filter.weigh(scores(drive[i].features), std::nullopt);
      for (const auto& hypothesis : hypotheses) {
        if (filter.neighbourhoodMass(hypothesis.place) < params_.belief.accept_threshold) continue;
        if (!confirmed(drive[i].features, bestView(drive[i].features, hypothesis.place))) continue;
        added.push_back({hypothesis.place, whole_.start(drive[i].features)});
        ++result.accepted;
        ++result.learnt;
        result.wrong += !isRight(i, hypothesis.place);
        break;
      }
    }
    for (auto& view : added) views_.push_back(std::move(view));
    rebuild();
    return result;
  }

  std::vector<double> scores(const types::Features& view) const override {
    const std::size_t places = map_.places().size();
    const std::vector<double> cosine = bag_.score(view.descriptors);
    std::vector<double> best(places, 0.0);
    std::vector<std::size_t> from(places, 0);
    for (std::size_t v = 0; v < cosine.size(); ++v) {
      const std::size_t p = bag_.placeOf(v).value;
      if (cosine[v] <= best[p]) continue;
      best[p] = std::min(1.0, cosine[v]);
      from[p] = v;
    }
    return checkBest(view, std::move(best), from);
  }

  Holdings holdings() const override {
    Holdings h;
    const auto places = static_cast<double>(map_.places().size());
    for (const auto& view : views_) {
      h.longTerm += static_cast<double>(view.memory.features.size()) / places;
      h.bytesPerPlace += static_cast<double>(store::storedBytes(view.memory)) / places;
    }
    h.bytesPerPlace += static_cast<double>(bag_.bytes()) / places;
    return h;
  }

  const map::TopologicalMap& map() const override { return map_; }

 private:
  struct Stored {
    base::PlaceId place;
    memory::PlaceMemory memory;
  };

  static vocabulary::BowParams bowParams(int words) {
    vocabulary::BowParams params;
    params.words = words;
    return params;
  }

  void rebuild() {
    std::vector<vocabulary::BagOfWords::View> views;
    for (const auto& v : views_) views.push_back({v.place, &v.memory.features.descriptors});
    bag_.rebuild(views);
  }

  bool confirmed(const types::Features& view, std::size_t stored) const {
    const auto match = pipeline::matchToPlace(view, views_[stored].memory, params_.match, params_.verify);
    return pipeline::strongEnough(match, params_.recognise);
  }

  std::size_t bestView(const types::Features& view, base::PlaceId place) const {
    const std::vector<double> cosine = bag_.score(view.descriptors);
    std::size_t best = cosine.size();
    for (std::size_t v = 0; v < cosine.size(); ++v)
      if (bag_.placeOf(v) == place && (best == cosine.size() || cosine[v] > cosine[best])) best = v;
    return best;
  }

  /// The places that look most alike go through the geometric check; those that fail it lose their score.
  /// When all fail, appearance is all there is.
  std::vector<double> checkBest(const types::Features& view, std::vector<double> score,
                                const std::vector<std::size_t>& from) const {
    std::vector<std::size_t> order(score.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return score[a] > score[b]; });
    order.resize(std::min(order.size(), static_cast<std::size_t>(params_.recognise.candidates)));
    std::vector<std::size_t> failed;
    for (const std::size_t p : order)
      if (!confirmed(view, from[p])) failed.push_back(p);
    if (failed.size() < order.size())
      for (const std::size_t p : failed) score[p] = 0.0;
    return score;
  }

  pipeline::PipelineParams params_;
  memory::Static whole_;
  map::TopologicalMap map_;  // places and edges; the views are in views_
  vocabulary::BagOfWords bag_;
  std::vector<Stored> views_;
};

}  // namespace

std::unique_ptr<Contender> makeContender(const Method& method, const std::vector<LearnView>& tour,
                                         const std::vector<Eigen::Isometry3d>& T_map_robot, bool closed) {
  if (method.words > 0)
    return std::make_unique<BagContender>(method, makeMap(memory::Static(), tour, T_map_robot, closed), tour);
  const auto model =
      memory::makeMemoryModel(method.params.memory, method.params.fsh, method.params.multi_store);
  return std::make_unique<MemoryContender>(method.params, makeMap(*model, tour, T_map_robot, closed));
}

}  // namespace engram::apps
