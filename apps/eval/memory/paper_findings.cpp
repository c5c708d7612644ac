// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/paper_findings.h"

#include <algorithm>
#include <map>
#include <optional>

namespace engram::apps {
namespace {

constexpr const char* kHistogram = "fsh";
constexpr const char* kStores = "multi_store_4_5";
constexpr const char* kBag = "bow_80";

/// The figures of one method in one condition, by update.
using OverUpdates = std::map<int, const LabFigure*>;

OverUpdates overUpdates(const std::vector<LabFigure>& figures, const std::string& method,
                        const std::string& condition) {
  OverUpdates found;
  for (const LabFigure& f : figures)
    if (f.method == method && f.condition == condition) found[f.update] = &f;
  return found;
}

/// The first update from which on the error stays below that after the first one. None when it does not in
/// the end.
std::optional<int> gainsFrom(const OverUpdates& run) {
  const double first = run.begin()->second->error.value;
  std::optional<int> from;
  for (const auto& [update, figure] : run) {
    const bool better = figure->error.value < first;
    if (!better) from.reset();
    if (better && !from) from = update;
  }
  return from;
}

std::string inWordsOf(std::optional<int> update) {
  return update ? "from update " + std::to_string(*update) : "never";
}

PaperFinding errorFalls(const OverUpdates& run, const std::string& condition) {
  const double first = run.begin()->second->error.value, last = run.rbegin()->second->error.value;
  return {"The error of the histogram falls with the updates (" + inWords(condition) + ")", last < first,
          line("%.2f places after update %d, %.2f after %d", first, run.begin()->first, last,
               run.rbegin()->first)};
}

/// F: one update later with noise, after update 3 and 4 with features removed.
void addDelays(const std::vector<LabFigure>& figures, std::vector<PaperFinding>& findings) {
  const OverUpdates clean = overUpdates(figures, kHistogram, "clean");
  for (const auto& condition : conditions()) {
    const OverUpdates run = overUpdates(figures, kHistogram, condition.name);
    if (run.size() < 2) continue;
    findings.push_back(errorFalls(run, condition.name));
    if (condition.name == "clean" || clean.size() < 2) continue;
    const auto without = gainsFrom(clean), with = gainsFrom(run);
    findings.push_back({"The gain of the histogram comes later (" + inWords(condition.name) + ")",
                        without && (!with || *with > *without),
                        inWordsOf(without) + " when clean, " + inWordsOf(with)});
  }
}

void addRivals(const std::vector<LabFigure>& figures, std::vector<PaperFinding>& findings) {
  const OverUpdates stores = overUpdates(figures, kStores, "clean"),
                    bag = overUpdates(figures, kBag, "clean");
  if (stores.contains(5)) {
    const auto from = gainsFrom(stores);
    findings.push_back({"The two stores (4 and 5 states) gain from update 5 on, not before",
                        from && *from >= 5, inWordsOf(from)});
  }
  if (bag.contains(3) && bag.contains(6)) {
    double worst = 0;
    for (const int update : {4, 5, 6}) worst = std::max(worst, bag.at(update)->error.value);
    const double before = bag.at(3)->error.value;
    findings.push_back({"The bag of words gets worse at updates 4 to 6", worst > before,
                        line("%.2f places after update 3, %.2f at worst after 4 to 6", before, worst)});
  }
}

void addEnd(const std::vector<LabFigure>& figures, std::vector<PaperFinding>& findings) {
  const OverUpdates ours = overUpdates(figures, kHistogram, "clean");
  if (ours.empty()) return;
  const LabFigure& last = *ours.rbegin()->second;
  findings.push_back({"After a wrong global answer local localisation recovers",
                      last.localSuccess.value > last.globalSuccess.value,
                      line("%.1f %% of first images are right, %.1f %% of those after them",
                           100 * last.globalSuccess.value, 100 * last.localSuccess.value)});
  for (const char* rival : {kStores, kBag}) {
    const OverUpdates run = overUpdates(figures, rival, "clean");
    if (run.empty()) continue;
    findings.push_back({std::string("The histogram errs less than ") + rival + " at the end",
                        last.error.value < run.rbegin()->second->error.value,
                        line("%.2f and %.2f places", last.error.value, run.rbegin()->second->error.value)});
  }
  const OverUpdates bag = overUpdates(figures, kBag, "clean");
  if (bag.empty()) return;
  const double ratio = bag.rbegin()->second->bytesPerPlace / last.bytesPerPlace;
  findings.push_back({"The map of the histogram is a fraction of that of the bag of words (paper: 8.4 times)",
                      ratio > 1, line("%.1f times", ratio)});
}

}  // namespace

std::vector<PaperFinding> paperFindings(const std::vector<LabFigure>& figures) {
  std::vector<PaperFinding> findings;
  addDelays(figures, findings);
  addRivals(figures, findings);
  addEnd(figures, findings);
  return findings;
}

ResultTable tableOf(const std::vector<PaperFinding>& findings) {
  using P = PaperFinding;
  Columns<P> c;
  c.add("claim", &P::claim).json().page("the paper says").text("the paper says", 82);
  c.add("found", &P::found).json();
  c.add("", [](const P& p) { return p.found ? "yes" : "no"; }).page("found").text("found", 6);
  c.add("figures", &P::figures).json().page("figures").text("figures", 0);
  return c.table(findings);
}

}  // namespace engram::apps
