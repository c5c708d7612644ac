// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "words/loop_figures.h"

#include "engram/exporters/charts.h"
#include "engram/exporters/page.h"

#include <nlohmann/json.hpp>

#include <array>
#include <cstdio>

namespace engram::apps {
namespace {

using evaluation::Verdict;

constexpr std::array<int, 4> kRanks{1, 5, 10, 25};

const char* const kScoreWords =
    "Answers are ordered by the number of verified matches plus the posterior of the place: an answer that "
    "geometry confirms comes before all others.";

const char* words(Verdict verdict) {
  switch (verdict) {
    case Verdict::kRight:
      return "right";
    case Verdict::kWrong:
      return "wrong";
    case Verdict::kUnknown:
      return "unknown";
  }
  return "?";
}

template <class... Values>
std::string line(const char* format, Values... values) {
  char text[512];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

/// Every accepted answer, and whether it is right.
exporters::Table closuresTable(const std::vector<LoopAnswer>& answers) {
  exporters::Table table{"Accepted answers", {"image", "place made by", "verdict", "matches + posterior"}};
  for (const auto& a : answers)
    if (a.accepted)
      table.rows.push_back({a.query.label, a.place->label, words(a.verdict), exporters::Cell(a.score, 2)});
  return table;
}

}  // namespace

LoopFigures figuresOf(const std::vector<LoopAnswer>& answers) {
  LoopFigures f;
  std::vector<evaluation::ScoredAnswer> scored;
  std::vector<double> times;
  std::map<int, int> found;
  for (const auto& a : answers) {
    ++f.images;
    f.positives += a.positive;
    f.accepted += a.accepted;
    f.bestGuessRight += a.positive && a.bestGuess == Verdict::kRight;
    times.push_back(a.milliseconds);
    for (const int k : kRanks) found[k] += a.positive && a.rank >= 0 && a.rank < k;
    if (!a.place || a.verdict == Verdict::kUnknown) continue;
    const bool right = a.verdict == Verdict::kRight;
    if (a.accepted) ++(right ? f.trueClosures : f.falseClosures);
    scored.push_back({a.score, right});
  }
  f.curve = evaluation::precisionRecall(scored, f.positives);
  for (const int k : kRanks)
    f.recallAt[k] = f.positives > 0 ? static_cast<double>(found[k]) / f.positives : 0.0;
  f.milliseconds = evaluation::percentiles(times);
  return f;
}

nlohmann::json toJson(const LoopFigures& f) {
  nlohmann::json recall;
  for (const auto& [k, share] : f.recallAt) recall[std::to_string(k)] = share;
  return {{"images", f.images},
          {"positives", f.positives},
          {"accepted", f.accepted},
          {"true_closures", f.trueClosures},
          {"false_closures", f.falseClosures},
          {"best_guess_right", f.bestGuessRight},
          {"recall_at_100_precision", f.curve.recallAtFullPrecision},
          {"auprc", f.curve.auprc},
          {"recall_at_k", recall},
          {"score", "verified matches + posterior"},
          {"ms_per_image",
           {{"mean", f.milliseconds.mean}, {"p95", f.milliseconds.p95}, {"max", f.milliseconds.max}}}};
}

std::string answersCsv(const std::vector<LoopAnswer>& answers) {
  std::string csv = "image,positive,outcome,accepted,place,verdict,best_guess,score,rank\n";
  for (const auto& a : answers)
    csv += line("%s,%d,%s,%d,%s,%s,%s,%.6f,%d\n", a.query.label.c_str(), a.positive ? 1 : 0,
                types::toString(a.outcome), a.accepted ? 1 : 0, a.place ? a.place->label.c_str() : "",
                words(a.verdict), words(a.bestGuess), a.score, a.rank);
  return csv;
}

std::string curveCsv(const evaluation::PrecisionRecall& curve) {
  std::string csv = "score,right,wrong,precision,recall\n";
  for (const auto& p : curve.points)
    csv += line("%.6f,%d,%d,%.6f,%.6f\n", p.threshold, p.right, p.wrong, p.precision, p.recall);
  return csv;
}

std::string toText(const LoopFigures& f) {
  std::string text = line("%d images, %d with a right answer\n", f.images, f.positives);
  text += line("accepted %d: %d true, %d false\n", f.accepted, f.trueClosures, f.falseClosures);
  text += line("best guess right %d, recall", f.bestGuessRight);
  for (const auto& [k, share] : f.recallAt) text += line(" @%d %.3f", k, share);
  text +=
      line("\nrecall at 100 %% precision %.3f, AUPRC %.3f\n", f.curve.recallAtFullPrecision, f.curve.auprc);
  text += line("ms per image: mean %.1f, p95 %.1f, max %.1f\n", f.milliseconds.mean, f.milliseconds.p95,
               f.milliseconds.max);
  return text;
}

std::string toHtml(const LoopFigures& f, const std::vector<LoopAnswer>& answers,
                   const std::string& settings) {
  exporters::Page page("Loop closures by visual words");
  page.preformatted(toText(f)).paragraph(kScoreWords);
  exporters::Curve curve{"precision over recall", 0, {}};
  for (const auto& p : f.curve.points) curve.points.push_back({100 * p.recall, {100 * p.precision}});
  exporters::ChartFrame frame{"Precision and recall", "recall [%]", "precision [%]"};
  frame.yRange = {0.0, 100.0};
  page.figure(exporters::curveChart(frame, {curve}),
              "One point for each score; the surest answers stand left.");
  page.table(closuresTable(answers));
  page.preformatted(settings, "Configuration");
  return page.html();
}

}  // namespace engram::apps
