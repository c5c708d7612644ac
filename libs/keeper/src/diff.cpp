// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/keeper/diff.h"

#include "engram/store/report_json.h"

#include <algorithm>
#include <functional>
#include <map>
#include <sstream>

namespace engram::keeper {
namespace {

/// By number, what tells whether two things are equal.
using Prints = std::map<std::uint64_t, std::string>;

KindDifference compared(const std::string& kind, const Prints& a, const Prints& b) {
  KindDifference d{kind, {}, {}, {}, 0};
  for (const auto& [id, print] : a) {
    const auto other = b.find(id);
    if (other == b.end())
      d.onlyA.push_back(id);
    else if (other->second != print)
      d.changed.push_back(id);
    else
      ++d.equal;
  }
  for (const auto& [id, print] : b)
    if (!a.contains(id)) d.onlyB.push_back(id);
  return d;
}

template <class Items>
Prints printsOf(const Items& items) {
  Prints prints;
  for (const auto& [id, item] : items) prints[id.value] = std::to_string(store::fingerprintOf(item));
  return prints;
}

Prints memoriesOf(const store::WholeMap& map) {
  Prints prints;
  for (const auto& [id, place] : map.content.places)
    prints[id.value] = std::to_string(store::fingerprintOf(id, place.memory));
  return prints;
}

Prints pathOf(const store::WholeMap& map) {
  Prints prints;
  for (std::size_t i = 0; i < map.content.path.size(); ++i)
    prints[i] = std::to_string(store::fingerprintOf(map.content.path[i], i));
  return prints;
}

Prints recordsOf(const store::WholeMap& map) {
  Prints prints;
  for (std::size_t i = 0; i < map.records.size(); ++i)
    prints[map.firstRecord + i] = store::toJson(map.records[i], false);
  return prints;
}

Prints drivesOf(const store::WholeMap& map) {
  Prints prints;
  for (const store::Drive& d : map.drives)
    prints[d.id] = store::describe(d) + ' ' + std::to_string(d.fingerprint) + (d.finished ? "" : " cut off");
  return prints;
}

void addLines(const std::string& a, const std::string& b, std::vector<std::string>& out) {
  const auto lines = [](const std::string& text) {
    std::vector<std::string> all;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
  };
  const auto linesA = lines(a), linesB = lines(b);
  const auto has = [](const std::vector<std::string>& all, const std::string& line) {
    return std::find(all.begin(), all.end(), line) != all.end();
  };
  for (const std::string& line : linesA)
    if (!has(linesB, line)) out.push_back("- " + line);
  for (const std::string& line : linesB)
    if (!has(linesA, line)) out.push_back("+ " + line);
}

std::string headText(const map::MapHeader& h) {
  std::ostringstream text;
  text << "engram_version = " << h.engramVersion << "\nextractor = " << h.extractor
       << "\ndescriptors = " << static_cast<int>(h.descriptorKind) << ' ' << h.descriptorDim
       << "\nmemory_model = " << h.memoryModel << '\n';
  return text.str();
}

}  // namespace

bool Difference::same() const {
  return parameters.empty() &&
         std::all_of(kinds.begin(), kinds.end(), [](const KindDifference& k) { return k.same(); });
}

Difference diff(const store::WholeMap& a, const store::WholeMap& b) {
  Difference d;
  d.kinds = {compared("places", printsOf(a.content.places), printsOf(b.content.places)),
             compared("memories", memoriesOf(a), memoriesOf(b)),
             compared("views", printsOf(a.content.views), printsOf(b.content.views)),
             compared("edges", printsOf(a.content.edges), printsOf(b.content.edges)),
             compared("path points", pathOf(a), pathOf(b)),
             compared("drives", drivesOf(a), drivesOf(b)),
             compared("records", recordsOf(a), recordsOf(b))};
  std::size_t both = 0;
  for (const auto& [id, place] : a.content.places) {
    const auto other = b.content.places.find(id);
    if (other == b.content.places.end()) continue;
    const double moved = (place.T_map_place.translation() - other->second.T_map_place.translation()).norm();
    d.movedMost = std::max(d.movedMost, moved);
    d.movedMean += moved;
    ++both;
  }
  if (both > 0) d.movedMean /= static_cast<double>(both);
  addLines(headText(a.header), headText(b.header), d.parameters);
  addLines(a.header.camera, b.header.camera, d.parameters);
  addLines(a.header.parameters, b.header.parameters, d.parameters);
  return d;
}

}  // namespace engram::keeper
