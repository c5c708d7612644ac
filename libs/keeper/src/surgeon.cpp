// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "surgeon.h"

#include "engram/map/topological_map.h"
#include "engram/upkeep/upkeep.h"

#include <algorithm>

namespace engram::keeper {
namespace {

/// A place that nothing joins to another one.
void removeLone(map::MapContent& content, map::PlaceId gone) {
  std::erase_if(content.views, [&](const auto& item) { return item.second.place == gone; });
  std::erase_if(content.path, [&](const map::PathPoint& point) { return point.anchor == gone; });
  content.places.erase(gone);
}

}  // namespace

void removePlaces(map::MapContent& content, const std::set<map::PlaceId>& gone, bool keepPath) {
  if (!keepPath)
    std::erase_if(content.path, [&](const map::PathPoint& point) { return gone.contains(point.anchor); });
  for (const map::PlaceId id : gone) content.places.at(id).joint = {};
  map::TopologicalMap map(std::move(content));
  std::vector<map::PlaceId> lone;
  for (const map::PlaceId id : gone) {
    if (map.neighbours(id).empty())
      lone.push_back(id);
    else
      upkeep::apply(map, {upkeep::RemoveView{id, {}}});
  }
  content = map.content();
  for (const map::PlaceId id : lone) removeLone(content, id);
}

std::size_t dropRecords(store::WholeMap& map, const std::function<bool(std::uint64_t)>& goes) {
  std::vector<types::FrameReport> kept;
  const std::uint64_t first = map.firstRecord, end = first + map.records.size();
  std::uint64_t next = first;
  for (std::size_t d = 0; d < map.drives.size(); ++d) {
    store::Drive& drive = map.drives[d];
    const std::uint64_t from = std::clamp(drive.firstRecord, first, end);
    const std::uint64_t to =
        d + 1 < map.drives.size() ? std::clamp(map.drives[d + 1].firstRecord, from, end) : end;
    const std::uint64_t had = to - from;
    drive.firstRecord = next;
    for (std::uint64_t i = from; i < to; ++i)
      if (!goes(i)) kept.push_back(std::move(map.records[i - first]));
    next = first + kept.size();
    // Of a drive whose records were forgotten before, the count of its images stays.
    if (had > 0) drive.images = next - drive.firstRecord;
  }
  if (map.drives.empty())
    for (std::uint64_t i = first; i < end; ++i)
      if (!goes(i)) kept.push_back(std::move(map.records[i - first]));
  const std::size_t dropped = map.records.size() - kept.size();
  map.records = std::move(kept);
  return dropped;
}

void forgetPlaces(std::vector<types::FrameReport>& records, const map::MapContent& content) {
  const auto unknown = [&](base::PlaceId id) { return id.valid() && !content.places.contains(id); };
  for (types::FrameReport& r : records) {
    if (unknown(r.place)) r.place = {};
    if (unknown(r.bestGuess)) r.bestGuess = {};
    std::erase_if(r.hypotheses, [&](const types::Hypothesis& h) { return unknown(h.place); });
    std::erase_if(r.learnt, unknown);
    if (r.pose && unknown(r.pose->place)) r.pose.reset();
  }
}

}  // namespace engram::keeper
