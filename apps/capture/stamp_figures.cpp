// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stamp_figures.h"

#include "engram/base/text.h"

#include <algorithm>
#include <iomanip>
#include <ostream>
#include <string>

namespace engram::apps {
namespace {

constexpr std::size_t kGapsShown = 5;

}  // namespace

void printStamps(std::ostream& out, const capture::StampStatistics::Summary& s) {
  if (s.images < 2) return;
  out << std::fixed << std::setprecision(2) << "  " << base::counted(s.images, "image") << " in "
      << s.last - s.first << " s, " << s.rate << " per second; interval " << 1e3 * s.interval << " ms +- "
      << 1e3 * s.jitter << " (95 %: " << 1e3 * s.interval95 << ", max: " << 1e3 * s.longest << ")\n";
  if (s.gaps.empty()) return;
  out << "  " << base::counted(s.gaps.size(), "gap") << ", room for " << base::counted(s.missing, "image")
      << (s.gaps.size() > kGapsShown ? "; the longest:\n" : ":\n");
  auto gaps = s.gaps;
  std::stable_sort(gaps.begin(), gaps.end(),
                   [](const auto& a, const auto& b) { return a.length > b.length; });
  for (std::size_t i = 0; i < std::min(gaps.size(), kGapsShown); ++i)
    out << "    " << gaps[i].length << " s after " << gaps[i].from - s.first << " s, "
        << base::counted(gaps[i].missing, "image") << "\n";
}

nlohmann::json stampsJson(const capture::StampStatistics::Summary& s) {
  nlohmann::json gaps = nlohmann::json::array();
  for (const auto& gap : s.gaps)
    gaps.push_back({{"from", gap.from}, {"seconds", gap.length}, {"missing", gap.missing}});
  return {
      {"seconds", s.last - s.first},
      {"interval_ms", {{"period", 1e3 * s.interval}, {"p95", 1e3 * s.interval95}, {"max", 1e3 * s.longest}}},
      {"jitter_ms", 1e3 * s.jitter},
      {"missing", s.missing},
      {"gaps", gaps}};
}

nlohmann::json cameraJson(const capture::CameraStats& c) {
  nlohmann::json gaps = nlohmann::json::array();
  for (const auto& gap : c.gaps) gaps.push_back({{"from", gap.from}, {"to", gap.to}});
  return {{"id", c.settings.id},
          {"vendor", c.settings.vendor},
          {"model", c.settings.model},
          {"serial", c.settings.serial},
          {"address", c.settings.address},
          {"format", c.settings.format},
          {"packet_size", c.settings.packetSize},
          {"whole", c.whole},
          {"incomplete", c.incomplete},
          {"missed", c.missed},
          {"reconnects", c.reconnects},
          {"lost", gaps},
          {"packets_missing", c.packets.missing},
          {"packets_resent", c.packets.resent},
          {"underruns", c.packets.underruns},
          {"clock_drift", c.clockDrift},
          {"clock_restarts", c.clockRestarts}};
}

}  // namespace engram::apps
