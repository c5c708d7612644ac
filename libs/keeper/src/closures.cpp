// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/keeper/closures.h"

#include "engram/base/error.h"
#include "engram/pipeline/closure_book.h"
#include "engram/posegraph/graph.h"
#include "place_pairs.h"

#include <algorithm>
#include <sstream>

namespace engram::keeper {
namespace {

bool isClosure(const map::Edge& edge) {
  return edge.type == map::EdgeType::kLoop || edge.type == map::EdgeType::kRecognition;
}

std::pair<map::PlaceId, map::PlaceId> ordered(map::PlaceId a, map::PlaceId b) { return std::minmax(a, b); }

Closure examined(const store::WholeMap& map, const map::Edge& edge, const PlacePairs& pairs) {
  const map::Place &a = map.content.places.at(edge.a), &b = map.content.places.at(edge.b);
  const types::Vector6d gap = posegraph::residual(edge.T_a_b, a.T_map_place, b.T_map_place);
  const pipeline::PlaceMatch match = pairs.match(a.memory, b.memory);
  return {edge.id,
          edge.type,
          edge.a,
          edge.b,
          gap.head<3>().norm(),
          gap.tail<3>().norm(),
          gap.dot(edge.T_a_b.cov.ldlt().solve(gap)),
          match.verified() ? static_cast<int>(match.matches.size()) : 0};
}

}  // namespace

Rejections rejectionsOf(const std::map<std::string, std::string>& notes) {
  Rejections rejections;
  const auto note = notes.find(kRejectedNote);
  if (note == notes.end()) return rejections;
  std::istringstream in(note->second);
  for (std::uint32_t a = 0, b = 0; in >> a >> b;)
    rejections.insert(ordered(map::PlaceId(a), map::PlaceId(b)));
  return rejections;
}

void setRejections(store::WholeMap& map, const Rejections& rejections) {
  std::string text;
  for (const auto& [a, b] : rejections)
    text += std::to_string(a.value) + ' ' + std::to_string(b.value) + '\n';
  if (text.empty())
    map.notes.erase(kRejectedNote);
  else
    map.notes[kRejectedNote] = text;
}

std::vector<Closure> closures(const store::WholeMap& map, const Configuration& configuration) {
  const PlacePairs pairs(configuration);
  std::vector<Closure> found;
  for (const auto& [id, edge] : map.content.edges)
    if (isClosure(edge)) found.push_back(examined(map, edge, pairs));
  return found;
}

void reject(store::WholeMap& map, std::span<const map::EdgeId> edges,
            const pipeline::PipelineParams& params) {
  Rejections rejections = rejectionsOf(map.notes);
  for (const map::EdgeId id : edges) {
    const auto at = map.content.edges.find(id);
    if (at == map.content.edges.end() || !isClosure(at->second))
      throw base::Error("there is no closure " + std::to_string(id.value) + ": see engram-map closures list");
    rejections.insert(ordered(at->second.a, at->second.b));
  }
  // Whatever joins the two places by recognition says the same.
  std::erase_if(map.content.edges, [&](const auto& item) {
    return isClosure(item.second) && rejections.contains(ordered(item.second.a, item.second.b));
  });
  setRejections(map, rejections);
  relaxAll(map.content, params);
}

Added addClosure(store::WholeMap& map, map::PlaceId a, map::PlaceId b, const Configuration& configuration) {
  for (const map::PlaceId id : {a, b})
    if (!map.content.places.contains(id))
      throw base::Error("the map has no place " + std::to_string(id.value));
  if (a == b) throw base::Error("a closure joins two places");
  const PlacePairs pairs(configuration);
  const pipeline::PlaceMatch match =
      pairs.match(map.content.places.at(b).memory, map.content.places.at(a).memory);
  Added added;
  added.matches = static_cast<int>(match.matches.size());
  if (!pipeline::strongEnough(match, pairs.params().recognise)) {
    added.reason = match.verified() ? "only " + std::to_string(added.matches) + " of their features agree"
                                    : "what they remember does not match: " +
                                          std::string(geometry::toString(match.reason));
    return added;
  }
  map::TopologicalMap whole(std::move(map.content));
  pipeline::ClosureBook book(pairs.params().posegraph);
  book.load(whole);
  const bool oneDrive = whole.place(a).session == whole.place(b).session;
  const auto decision =
      book.propose(whole, {.type = oneDrive ? map::EdgeType::kLoop : map::EdgeType::kRecognition,
                           .a = a,
                           .b = b,
                           .T_a_b = pairs.T_place_view(match)});
  added.accepted = decision.accepted;
  if (decision.accepted)
    added.edge = book.apply(whole).proposed;
  else
    added.reason = std::string("the graph refuses it: ") + posegraph::toString(decision.reason);
  map.content = whole.content();
  if (!added.accepted) return added;
  Rejections rejections = rejectionsOf(map.notes);
  rejections.erase(ordered(a, b));
  setRejections(map, rejections);
  return added;
}

}  // namespace engram::keeper
