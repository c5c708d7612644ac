// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/exporters/html_report.h"

#include "charts.h"
#include "map_chart.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace engram::exporters {
namespace {

using Rows = std::vector<std::pair<std::string, std::string>>;

constexpr const char* kStyle = R"(
body { font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; color: #1b1b1b; background: #fff; max-width: 1080px;
       margin: 24px auto; padding: 0 16px; }
h1 { font-size: 24px; margin: 0 0 4px; }
h2 { font-size: 18px; margin: 32px 0 8px; border-bottom: 1px solid #ccc; padding-bottom: 2px; }
table { border-collapse: collapse; margin: 8px 0; }
th, td { text-align: left; padding: 3px 18px 3px 0; border-bottom: 1px solid #e4e4e4; vertical-align: top; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
.two { display: flex; flex-wrap: wrap; gap: 20px 40px; align-items: flex-start; }
svg { max-width: 100%; height: auto; }
svg text { font-size: 12px; fill: #1b1b1b; font-family: system-ui, "DejaVu Sans", sans-serif; }
svg text.title { font-weight: 600; font-size: 13px; }
svg .grid { stroke: #e8e8e8; stroke-width: 1; }
svg .axis { stroke: #444; stroke-width: 1; }
pre { background: #f6f6f6; padding: 10px; overflow-x: auto; font-size: 12.5px; }
p.note { color: #444; margin: 4px 0; }
.share { display: inline-block; height: 10px; background: #0072b2; }
)";

std::string table(const Rows& rows) {
  std::string out = "<table>\n";
  for (const auto& [name, value] : rows)
    out += "<tr><th>" + escaped(name) + "</th><td class=\"n\">" + escaped(value) + "</td></tr>\n";
  return out + "</table>\n";
}

std::string section(const std::string& title) { return "<h2>" + escaped(title) + "</h2>\n"; }

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
    longTerm += place.memory.longTerm().size();
    all += place.memory.states.size();
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

std::string reasonsTable(std::span<const types::FrameReport> records) {
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
  if (counts.empty()) return {};
  std::vector<std::pair<int, std::string>> sorted;
  for (const auto& [kind, n] : counts) sorted.emplace_back(-n, kind);
  std::sort(sorted.begin(), sorted.end());
  std::string out = "<table><tr><th>Why not (# stands for a number)</th><th class=\"n\">images</th></tr>\n";
  for (std::size_t i = 0; i < std::min<std::size_t>(sorted.size(), 12); ++i)
    out += "<tr><td>" + escaped(sorted[i].second) + "</td><td class=\"n\">" +
           std::to_string(-sorted[i].first) + "</td></tr>\n";
  return out + "</table>\n";
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

std::string timeSection(std::span<const types::FrameReport> records) {
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
  std::string out = section("Time per image");
  out +=
      "<div class=\"two\"><table><tr><th>Step</th><th class=\"n\">images</th><th class=\"n\">mean [ms]</th>"
      "<th class=\"n\">95 % [ms]</th><th class=\"n\">max [ms]</th><th>share of all time</th></tr>\n";
  for (const auto& step : order) out += timeRow(step, ofStep.at(step), total);
  out += timeRow("whole image", whole, total) + "</table>\n";
  out +=
      lineChart({"Time over the drive", "image", "time [ms]"}, {{"whole image", categoryColour(0), whole}});
  return out + "</div>\n";
}

std::string recordSections(std::span<const types::FrameReport> records) {
  std::vector<double> accepted, refused, features;
  for (const auto& r : records) {
    features.push_back(r.features);
    if (r.hypotheses.empty()) continue;
    (r.outcome == types::Outcome::kRecognised ? accepted : refused)
        .push_back(r.hypotheses.front().similarity);
  }
  std::string out = section("Recognition") + "<div class=\"two\">\n";
  out += histogram({"Similarity of the best hypothesis", "similarity", "images"},
                   {{"accepted", categoryColour(2), accepted}, {"not accepted", categoryColour(1), refused}},
                   20);
  out += lineChart({"Features found", "image", "features"}, {{"features", categoryColour(4), features}});
  out += reasonsTable(records) + "</div>\n";
  return out + timeSection(records);
}

std::string memorySection(const map::TopologicalMap& map) {
  std::vector<double> longTerm, shortTerm, updates;
  for (const auto& [id, place] : map.places()) {
    longTerm.push_back(static_cast<double>(place.memory.longTerm().size()));
    shortTerm.push_back(static_cast<double>(place.memory.states.size()) - longTerm.back());
    updates.push_back(place.memory.updates);
  }
  return section("Memory") + "<div class=\"two\">\n" +
         histogram({"Features of a place", "features", "places"},
                   {{"long-term", categoryColour(0), longTerm}, {"short-term", categoryColour(1), shortTerm}},
                   16) +
         histogram({"Views a place has learnt from", "views", "places"},
                   {{"places", categoryColour(2), updates}}, 16) +
         "</div>\n";
}

std::string headerSection(const map::MapHeader& h) {
  const char* const kinds[] = {"float", "int8", "binary"};
  std::string out = section("Made with");
  out += table(
      {{"Engram", h.engramVersion},
       {"Extractor", h.extractor},
       {"Descriptors", std::string(kinds[static_cast<std::size_t>(h.descriptorKind) % 3]) + ", " +
                           std::to_string(h.descriptorDim) +
                           (h.descriptorKind == types::DescriptorKind::kBinary ? " bits" : " components")},
       {"Memory model", h.memoryModel},
       {"First image at [s]", number(h.firstStamp, 16)}});
  out += "<details><summary>Camera</summary><pre>" + escaped(h.camera) + "</pre></details>\n";
  return out + "<details><summary>Parameters</summary><pre>" + escaped(h.parameters) + "</pre></details>\n";
}

}  // namespace

std::string toHtml(const HtmlReport& report) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>" +
      escaped(report.title) + "</title>\n<style>" + kStyle + "</style></head>\n<body>\n<h1>" +
      escaped(report.title) + "</h1>\n";
  out += section("Figures") + "<div class=\"two\">\n";
  if (!report.figures.empty()) out += table(report.figures);
  if (report.map != nullptr) out += table(mapRows(*report.map));
  if (!report.records.empty()) out += table(outcomeRows(report.records));
  out += "</div>\n";
  if (report.map != nullptr && !report.map->empty())
    out += section("Map") + mapChart(*report.map) +
           "<p class=\"note\">Thin lines are the robot's path, one colour a session. Point at a place for "
           "its memory.</p>\n";
  if (report.map != nullptr && !report.map->empty()) out += memorySection(*report.map);
  if (!report.records.empty()) out += recordSections(report.records);
  if (report.header != nullptr) out += headerSection(*report.header);
  return out + "</body>\n</html>\n";
}

}  // namespace engram::exporters
