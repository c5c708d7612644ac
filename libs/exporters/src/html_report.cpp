// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/exporters/html_report.h"

#include "engram/charts/charts.h"
#include "engram/charts/markup.h"
#include "engram/charts/page.h"
#include "map_chart.h"
#include "map_colours.h"
#include "picture_pairs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace engram::exporters {
namespace {

using charts::Cell;
using charts::ChartFrame;
using charts::escaped;
using charts::number;
using charts::Page;
using charts::Table;
using Rows = std::vector<std::pair<std::string, std::string>>;

ChartFrame frame(const std::string& title, const std::string& xLabel, const std::string& yLabel) {
  return {.title = title, .xLabel = xLabel, .yLabel = yLabel, .width = 520, .height = 280};
}

/// Names and figures, the latter on the right though they are words.
Table asTable(const Rows& rows) {
  Table out{.rowHeads = true};
  for (const auto& [name, value] : rows) {
    out.rows.push_back({name, value});
    out.rows.back().back().right = true;
  }
  return out;
}

double pathLength(const map::TopologicalMap& map) {
  double sum = 0;
  for (std::size_t i = 1; i < map.path().size(); ++i)
    if (map.path()[i].session == map.path()[i - 1].session)
      sum += (map.T_map_robot(map.path()[i]).translation() - map.T_map_robot(map.path()[i - 1]).translation())
                 .norm();
  return sum;
}

Rows mapRows(const map::TopologicalMap& map) {
  std::size_t longTerm = 0, all = 0;
  for (const auto& [id, place] : map.places()) {
    longTerm += place.memory->longTerm().size();
    all += place.memory->states.size();
  }
  Rows rows{{"Places", std::to_string(map.places().size())},
            {"Views", std::to_string(map.views().size())},
            {"Sessions", std::to_string(map.nextSession())},
            {"Connected parts", std::to_string(map.components().size())}};
  for (const map::EdgeType type : kEdgeTypes) {
    const auto n = std::count_if(map.edges().begin(), map.edges().end(),
                                 [&](const auto& e) { return e.second.type == type; });
    if (n > 0) rows.emplace_back(std::string("Edges: ") + map::toString(type), std::to_string(n));
  }
  rows.emplace_back("Length of the path [m]", number(pathLength(map)));
  rows.emplace_back("Long-term features", std::to_string(longTerm));
  rows.emplace_back("Short-term features", std::to_string(all - longTerm));
  return rows;
}

Rows outcomeRows(std::span<const types::FrameReport> records) {
  std::map<types::Outcome, int> counts;
  int closures = 0;
  for (const auto& r : records) {
    ++counts[r.outcome];
    closures += r.closure ? 1 : 0;
  }
  Rows rows{{"Images", std::to_string(records.size())}};
  for (const auto& [outcome, n] : counts)
    rows.emplace_back(std::string("… ") + types::toString(outcome), std::to_string(n));
  rows.emplace_back("Loop closures", std::to_string(closures));
  return rows;
}

void addReasons(Page& page, std::span<const types::FrameReport> records) {
  std::map<std::string, int> counts;
  for (const auto& r : records)
    if (!r.reason.empty()) {
      // Reasons carry numbers ("11 of 30 inliers"); what stays when they are gone is the kind.
      std::string kind;
      for (const char c : r.reason) {
        const bool digit = (c >= '0' && c <= '9') || (c == '.' && !kind.empty() && kind.back() == '#');
        if (!digit)
          kind += c;
        else if (kind.empty() || kind.back() != '#')
          kind += '#';
      }
      ++counts[kind];
    }
  if (counts.empty()) return;
  std::vector<std::pair<int, std::string>> sorted;
  for (const auto& [kind, n] : counts) sorted.emplace_back(-n, kind);
  std::sort(sorted.begin(), sorted.end());
  Table out{.header = {"Why not (# stands for a number)", "images"}};
  for (std::size_t i = 0; i < std::min<std::size_t>(sorted.size(), 12); ++i)
    out.rows.push_back({sorted[i].second, Cell(-sorted[i].first, 0)});
  page.table(out);
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::nan("");
  const auto at = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? std::nan("") : sum / static_cast<double>(values.size());
}

std::string timeRow(const std::string& step, const std::vector<double>& ms, double total) {
  const double share = total > 0 ? mean(ms) * static_cast<double>(ms.size()) / total : 0;
  return "<tr><td>" + escaped(step) + "</td><td class=\"n\">" + std::to_string(ms.size()) +
         "</td><td class=\"n\">" + number(mean(ms), 3) + "</td><td class=\"n\">" +
         number(quantile(ms, 0.95), 3) + "</td><td class=\"n\">" +
         number(*std::max_element(ms.begin(), ms.end()), 3) +
         "</td><td><span class=\"share\" style=\"width:" + number(std::round(160 * share)) + "px\"></span> " +
         number(std::round(100 * share)) + " %</td></tr>\n";
}

void addTimes(Page& page, std::span<const types::FrameReport> records) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<double>> ofStep;
  std::vector<double> whole;
  double total = 0;
  for (const auto& r : records) {
    whole.push_back(r.milliseconds);
    total += r.milliseconds;
    for (const auto& t : r.times) {
      if (!ofStep.contains(t.step)) order.push_back(t.step);
      ofStep[t.step].push_back(t.milliseconds);
    }
  }
  page.heading("Time per image").beginRow();
  std::string out =
      "<table><thead><tr><th>Step</th><th class=\"n\">images</th><th class=\"n\">mean [ms]</th>"
      "<th class=\"n\">95 % [ms]</th><th class=\"n\">max [ms]</th><th>share of all "
      "time</th></tr></thead><tbody>\n";
  for (const auto& step : order) out += timeRow(step, ofStep.at(step), total);
  page.append(out + timeRow("whole image", whole, total) + "</tbody></table>\n");
  page.append(timeline(frame("Time over the drive", "image", "time [ms]"), {{"whole image", 0, whole}}));
}

void addRecords(Page& page, std::span<const types::FrameReport> records) {
  std::vector<double> accepted, refused, features;
  for (const auto& r : records) {
    features.push_back(r.features);
    if (r.hypotheses.empty()) continue;
    (r.outcome == types::Outcome::kRecognised ? accepted : refused)
        .push_back(r.hypotheses.front().similarity);
  }
  page.heading("Recognition").beginRow();
  page.append(histogram(frame("Similarity of the best hypothesis", "similarity", "images"),
                        {{"accepted", 2, accepted}, {"not accepted", 1, refused}}, 20));
  page.append(timeline(frame("Features found", "image", "features"), {{"features", 4, features}}));
  addReasons(page, records);
  addTimes(page, records);
}

void addMemory(Page& page, const map::TopologicalMap& map) {
  std::vector<double> longTerm, shortTerm, updates;
  for (const auto& [id, place] : map.places()) {
    longTerm.push_back(static_cast<double>(place.memory->longTerm().size()));
    shortTerm.push_back(static_cast<double>(place.memory->states.size()) - longTerm.back());
    updates.push_back(place.memory->updates);
  }
  page.heading("Memory").beginRow();
  page.append(histogram(frame("Features of a place", "features", "places"),
                        {{"long-term", 0, longTerm}, {"short-term", 1, shortTerm}}, 16));
  page.append(
      histogram(frame("Views a place has learnt from", "views", "places"), {{"places", 2, updates}}, 16));
}

void addHeader(Page& page, const map::MapHeader& h) {
  const char* const kinds[] = {"float", "int8", "binary"};
  page.heading("Made with");
  page.table(asTable(
      {{"Engram", h.engramVersion},
       {"Extractor", h.extractor},
       {"Descriptors", std::string(kinds[static_cast<std::size_t>(h.descriptorKind) % 3]) + ", " +
                           std::to_string(h.descriptorDim) +
                           (h.descriptorKind == types::DescriptorKind::kBinary ? " bits" : " components")},
       {"Memory model", h.memoryModel},
       {"First image at [s]", number(h.firstStamp, 16)}}));
  page.preformatted(h.camera, "Camera").preformatted(h.parameters, "Parameters");
}

}  // namespace

std::string toHtml(const HtmlReport& report) {
  Page page(report.title);
  page.heading("Figures").beginRow();
  if (!report.figures.empty()) page.table(asTable(report.figures));
  if (report.map != nullptr) page.table(asTable(mapRows(*report.map)));
  if (!report.records.empty()) page.table(asTable(outcomeRows(report.records)));
  if (report.map != nullptr && !report.map->empty()) {
    page.heading("Map").append(mapChart(*report.map));
    page.note("Thin lines are the robot's path, one colour a session. Point at a place for its memory.");
    addPicturePairs(page, report);
    addMemory(page, *report.map);
  }
  if (!report.records.empty()) addRecords(page, report.records);
  if (report.header != nullptr) addHeader(page, *report.header);
  return page.html();
}

}  // namespace engram::exporters
