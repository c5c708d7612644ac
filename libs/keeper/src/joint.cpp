// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "joint.h"

#include "engram/pipeline/recogniser.h"

#include <algorithm>
#include <cmath>

namespace engram::keeper {
namespace {

constexpr double kAgreeDistance = 1.0;  // [m] that two joints may differ on where b lies,
constexpr double kAgreeAngle = 0.35;    // [rad] that they may
constexpr std::size_t kVoters = 400;    // joints with most matches: enough to tell where b lies

int inliersOf(const pipeline::PlaceMatch& match) {
  return match.verified() ? static_cast<int>(match.matches.size()) : 0;
}

/// The places of a that look most like a view, matched.
class Search {
 public:
  Search(const map::MapContent& a, const PlacePairs& pairs)
      : map_(a),
        pairs_(pairs),
        recogniser_(pairs.params(), pipeline::Recogniser::Mode::kLocalisation, pairs.stereo()) {
    recogniser_.load(map_);
    for (const auto& [id, place] : map_.places()) ids_.push_back(id);
  }

  std::optional<Joint> find(const map::Place& place) const {
    const std::vector<double> scores = recogniser_.similarities(place.memory->features);
    std::vector<std::size_t> order(scores.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    const auto most = std::min(order.size(), static_cast<std::size_t>(pairs_.params().recognise.candidates));
    std::partial_sort(
        order.begin(), order.begin() + static_cast<std::ptrdiff_t>(most), order.end(),
        [&](std::size_t i, std::size_t j) { return scores[i] != scores[j] ? scores[i] > scores[j] : i < j; });
    std::map<map::PlaceId, pipeline::PlaceMatch> matches;
    for (std::size_t k = 0; k < most; ++k)
      matches[ids_[order[k]]] = pairs_.match(place.memory, map_.place(ids_[order[k]]).memory);
    return best(place, matches);
  }

 private:
  std::optional<Joint> best(const map::Place& place,
                            const std::map<map::PlaceId, pipeline::PlaceMatch>& matches) const {
    const auto at = std::max_element(matches.begin(), matches.end(), [](const auto& x, const auto& y) {
      return inliersOf(x.second) < inliersOf(y.second);
    });
    const pipeline::RecogniseParams& params = pairs_.params().recognise;
    if (at == matches.end() || !pipeline::strongEnough(at->second, params)) return std::nullopt;
    if (inliersOf(at->second) < params.closure_inliers || rivalled(at->first, matches)) return std::nullopt;
    Joint joint{at->first, place.id, pairs_.T_place_view(at->second), at->second.matches, {}};
    joint.T_maps =
        types::rigid(map_.place(joint.a).T_map_place * joint.T_a_b.T_a_b * place.T_map_place.inverse());
    return joint;
  }

  /// Whether a place elsewhere has nearly as many of its features.
  bool rivalled(map::PlaceId best, const std::map<map::PlaceId, pipeline::PlaceMatch>& matches) const {
    const auto& params = pairs_.params();
    if (params.recognise.ambiguity <= 0) return false;
    const auto near = map_.hopDistances(best, params.place.recent_hops);
    const int most = inliersOf(matches.at(best));
    return std::any_of(matches.begin(), matches.end(), [&](const auto& other) {
      const double away =
          (map_.place(other.first).T_map_place.translation() - map_.place(best).T_map_place.translation())
              .norm();
      return other.first != best && !near.contains(other.first) && away > 2 * params.place.spacing &&
             inliersOf(other.second) >= params.recognise.ambiguity * most;
    });
  }

  map::TopologicalMap map_;
  const PlacePairs& pairs_;
  pipeline::Recogniser recogniser_;
  std::vector<map::PlaceId> ids_;
};

/// Whether two joints put b at the same spot of a, seen from between them.
bool agree(const Joint& x, const Joint& y, const map::MapContent& a, double drift) {
  const Eigen::Vector3d px = a.places.at(x.a).T_map_place.translation(),
                        py = a.places.at(y.a).T_map_place.translation();
  const Eigen::Isometry3d T = x.T_maps.inverse() * y.T_maps;
  const Eigen::Vector3d inB = x.T_maps.inverse() * Eigen::Vector3d(0.5 * (px + py));
  const double gap = (T * inB - inB).norm();
  const double angle = Eigen::AngleAxisd(T.linear()).angle();
  const double way = (px - py).norm();
  return gap <= kAgreeDistance + drift * way && angle <= kAgreeAngle + drift * way / 10;
}

}  // namespace

std::vector<Joint> recognised(const map::MapContent& a, const map::MapContent& b, const PlacePairs& pairs,
                              const std::function<void(double)>& progress) {
  const Search search(a, pairs);
  std::vector<Joint> joints;
  std::size_t done = 0;
  for (const auto& [id, place] : b.places) {
    if (auto joint = search.find(place)) joints.push_back(std::move(*joint));
    if (progress) progress(static_cast<double>(++done) / static_cast<double>(b.places.size()));
  }
  return joints;
}

std::vector<Joint> agreeing(std::vector<Joint> joints, const map::MapContent& a, const PlacePairs& pairs) {
  const double drift = pairs.params().odometry.max_drift;
  std::stable_sort(joints.begin(), joints.end(),
                   [](const Joint& x, const Joint& y) { return x.matches.size() > y.matches.size(); });
  const std::size_t voters = std::min(joints.size(), kVoters);
  std::size_t best = 0, most = 0;
  for (std::size_t i = 0; i < voters; ++i) {
    std::size_t votes = 0;
    for (std::size_t j = 0; j < voters; ++j) votes += agree(joints[i], joints[j], a, drift);
    if (votes > most) {
      most = votes;
      best = i;
    }
  }
  if (joints.empty()) return joints;
  const Joint speaker = joints[best];
  std::erase_if(joints, [&](const Joint& joint) { return !agree(speaker, joint, a, drift); });
  const auto at =
      std::find_if(joints.begin(), joints.end(), [&](const Joint& j) { return j.b == speaker.b; });
  std::rotate(joints.begin(), at, at + 1);
  return joints;
}

std::size_t besidePlaces(const std::vector<Joint>& joints, const map::MapContent& a, const map::MapContent& b,
                         double beside) {
  std::size_t count = 0;
  for (const auto& [id, place] : b.places) {
    const Eigen::Vector3d here = place.T_map_place.translation();
    const auto away = [&](const Joint& j) {
      return (b.places.at(j.b).T_map_place.translation() - here).squaredNorm();
    };
    const Joint& nearest = *std::min_element(
        joints.begin(), joints.end(), [&](const Joint& x, const Joint& y) { return away(x) < away(y); });
    const Eigen::Vector3d inA = nearest.T_maps * here;
    count += std::any_of(a.places.begin(), a.places.end(), [&](const auto& item) {
      return (item.second.T_map_place.translation() - inA).norm() <= beside;
    });
  }
  return count;
}

}  // namespace engram::keeper
