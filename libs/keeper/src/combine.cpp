// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "combine.h"

#include "engram/base/error.h"
#include "engram/keeper/closures.h"
#include "engram/map/topological_map.h"
#include "engram/memory/unite.h"
#include "engram/types/se3.h"

#include <algorithm>

namespace engram::keeper {
namespace {

bool sameDrive(const store::Drive& x, const store::Drive& y) {
  return x.fingerprint == y.fingerprint && x.firstStamp == y.firstStamp && x.source == y.source;
}

bool samePlace(const map::Place& x, const map::Place& y) {
  return x.createdStamp == y.createdStamp && x.createdIndex == y.createdIndex &&
         x.createdLabel == y.createdLabel && x.session == y.session;
}

bool sameView(const map::View& x, const map::View& y) {
  return x.place == y.place && x.stamp == y.stamp && x.frameIndex == y.frameIndex && x.session == y.session;
}

/// Writes b behind a, kind by kind.
class Combiner {
 public:
  Combiner(store::WholeMap& a, const store::WholeMap& b, const CommonPast& past,
           const Eigen::Isometry3d& T_a_b)
      : a_(a), b_(b), past_(past), T_a_b_(T_a_b) {
    numbers_.place = a.content.nextPlace;
    numbers_.view = a.content.nextView;
    numbers_.edge = a.content.nextEdge;
    numbers_.session = map::TopologicalMap(a.content).nextSession();
    for (const map::PlaceId id : past.places) numbers_.places[id] = id;
  }

  Numbering run() {
    requireNumbers();
    addPlaces();
    addViews();
    addEdges();
    addPath();
    addDrives();
    addNotes();
    for (auto& [id, edge] : a_.content.edges) dropUnknown(edge);
    auto& c = a_.content;
    c.nextPlace += b_.content.nextPlace;
    c.nextView += b_.content.nextView;
    c.nextEdge += b_.content.nextEdge;
    const bool apart = past_.drives.empty();
    const auto &seenA = c.redetections, &seenB = b_.content.redetections;
    c.redetections = apart ? memory::sum(seenA, seenB) : (seenB.views > seenA.views ? seenB : seenA);
    return numbers_;
  }

 private:
  void requireNumbers() const {
    const auto &x = a_.content, &y = b_.content;
    for (const auto& [p, q] : {std::pair(x.nextPlace, y.nextPlace), std::pair(x.nextView, y.nextView),
                               std::pair(x.nextEdge, y.nextEdge)})
      if (std::uint64_t{p} + q >= map::kMostIds)
        throw base::Error("the maps have used up their numbers: no map can hold both");
  }
  int sessionOf(int session) const {
    const auto shared = past_.sessions.find(session);
    if (shared != past_.sessions.end()) return shared->second;
    return session < 0 ? session : session + numbers_.session;
  }

  void addPlaces() {
    for (const auto& [id, theirs] : b_.content.places) {
      if (past_.places.contains(id)) {
        map::Place& ours = a_.content.places.at(id);
        if (theirs.memory->updates > ours.memory->updates) ours.memory = theirs.memory;
        continue;
      }
      map::Place place = theirs;
      place.id = numbers_.of(id);
      place.T_map_place = types::rigid(T_a_b_ * theirs.T_map_place);
      place.session = sessionOf(theirs.session);
      place.joint = {};
      a_.content.places.emplace(place.id, std::move(place));
    }
  }
  void addViews() {
    for (const auto& [id, theirs] : b_.content.views) {
      const auto ours = a_.content.views.find(id);
      if (ours != a_.content.views.end() && past_.places.contains(theirs.place) &&
          sameView(ours->second, theirs))
        continue;
      map::View view = theirs;
      view.id = map::ViewId(id.value + numbers_.view);
      view.place = numbers_.of(theirs.place);
      view.session = sessionOf(theirs.session);
      a_.content.views.emplace(view.id, std::move(view));
    }
  }
  void addEdges() {
    for (const auto& [id, theirs] : b_.content.edges) {
      const auto ours = a_.content.edges.find(id);
      if (ours != a_.content.edges.end() && past_.places.contains(theirs.a) &&
          past_.places.contains(theirs.b) && ours->second.a == theirs.a && ours->second.b == theirs.b)
        continue;
      map::Edge edge = theirs;
      edge.id = map::EdgeId(id.value + numbers_.edge);
      edge.a = numbers_.of(theirs.a);
      edge.b = numbers_.of(theirs.b);
      a_.content.edges.emplace(edge.id, std::move(edge));
    }
  }
  /// The memory of a common place may have let go what an edge of the other map names.
  void dropUnknown(map::Edge& edge) const {
    const auto knows = [&](map::PlaceId place, std::uint32_t feature) {
      const auto& states = a_.content.places.at(place).memory->states;
      return std::any_of(states.begin(), states.end(), [&](const auto& s) { return s.id == feature; });
    };
    if (past_.places.contains(edge.a) || past_.places.contains(edge.b))
      std::erase_if(edge.correspondences, [&](const auto& pair) {
        return !knows(edge.a, pair.first) || !knows(edge.b, pair.second);
      });
  }
  void addPath() {
    // A drive that both know may have gone on in b.
    std::set<std::pair<int, double>> known;
    for (const map::PathPoint& point : a_.content.path) known.emplace(point.session, point.stamp);
    for (map::PathPoint point : b_.content.path) {
      if (past_.sessions.contains(point.session) && known.contains({sessionOf(point.session), point.stamp}))
        continue;
      point.session = sessionOf(point.session);
      point.anchor = numbers_.of(point.anchor);
      a_.content.path.push_back(point);
    }
  }
  void addDrives() {
    for (const store::Drive& theirs : b_.drives) {
      if (past_.drives.contains(theirs.id)) continue;
      store::Drive drive = theirs;
      drive.id = static_cast<std::uint32_t>(a_.drives.size());
      drive.session = sessionOf(theirs.session);
      drive.firstRecord = a_.firstRecord + a_.records.size();
      const std::uint64_t first = std::max(theirs.firstRecord, b_.firstRecord);
      const std::uint64_t end = theirs.id + 1u < b_.drives.size() ? b_.drives[theirs.id + 1u].firstRecord
                                                                  : b_.firstRecord + b_.records.size();
      for (std::uint64_t i = first; i < end; ++i) addRecord(b_.records[i - b_.firstRecord]);
      a_.drives.push_back(std::move(drive));
    }
  }
  void addRecord(types::FrameReport report) {
    report.place = numbers_.of(report.place);
    report.bestGuess = numbers_.of(report.bestGuess);
    report.bestGuessInterpolated = -1;  // it counted the places of b
    for (auto& hypothesis : report.hypotheses) hypothesis.place = numbers_.of(hypothesis.place);
    for (auto& place : report.learnt) place = numbers_.of(place);
    if (report.pose) {
      report.pose->place = numbers_.of(report.pose->place);
      report.pose->T_map_robot = types::rigid(T_a_b_ * report.pose->T_map_robot);
    }
    a_.records.push_back(std::move(report));
  }
  void addNotes() {
    Rejections rejections = rejectionsOf(a_.notes);
    for (const auto& [x, y] : rejectionsOf(b_.notes))
      rejections.insert(std::minmax(numbers_.of(x), numbers_.of(y)));
    setRejections(a_, rejections);
  }

  store::WholeMap& a_;
  const store::WholeMap& b_;
  const CommonPast& past_;
  Eigen::Isometry3d T_a_b_;
  Numbering numbers_;
};

}  // namespace

map::PlaceId Numbering::of(map::PlaceId id) const {
  if (!id.valid()) return id;
  const auto known = places.find(id);
  return known != places.end() ? known->second : map::PlaceId(id.value + place);
}

CommonPast commonPast(const store::WholeMap& a, const store::WholeMap& b) {
  CommonPast past;
  for (const store::Drive& theirs : b.drives)
    for (const store::Drive& ours : a.drives)
      if (sameDrive(ours, theirs)) {
        past.drives.insert(theirs.id);
        if (theirs.session >= 0 && ours.session >= 0) past.sessions[theirs.session] = ours.session;
      }
  for (const auto& [id, theirs] : b.content.places) {
    const auto ours = a.content.places.find(id);
    if (ours != a.content.places.end() && past.sessions.contains(theirs.session) &&
        samePlace(ours->second, theirs))
      past.places.insert(id);
  }
  return past;
}

Numbering combine(store::WholeMap& a, const store::WholeMap& b, const CommonPast& past,
                  const Eigen::Isometry3d& T_a_b) {
  return Combiner(a, b, past, T_a_b).run();
}

}  // namespace engram::keeper
