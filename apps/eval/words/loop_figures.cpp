// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "words/loop_figures.h"

#include "engram/charts/charts.h"
#include "engram/charts/page.h"

#include <array>

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

ResultTable tableOf(const std::vector<LoopAnswer>& answers) {
  using A = LoopAnswer;
  Columns<A> c;
  c.add("image", [](const A& a) { return a.query.label; }).csv().page("image");
  c.add("positive", &A::positive).csv();
  c.add("outcome", [](const A& a) { return types::toString(a.outcome); }).csv();
  c.add("accepted", &A::accepted).csv();
  c.add("place", [](const A& a) { return a.place ? a.place->label : ""; }).csv().page("place made by");
  c.add("verdict", [](const A& a) { return words(a.verdict); }).csv().page("verdict");
  c.add("best_guess", [](const A& a) { return words(a.bestGuess); }).csv();
  c.add("score", &A::score).csv(6).page("matches + posterior", fixed(2));
  c.add("rank", &A::rank).csv();
  return c.table(answers);
}

ResultTable tableOf(const evaluation::PrecisionRecall& curve) {
  using P = evaluation::PrecisionRecallPoint;
  Columns<P> c;
  c.add("score", &P::threshold).csv(6);
  c.add("right", &P::right).csv();
  c.add("wrong", &P::wrong).csv();
  c.add("precision", &P::precision).csv(6);
  c.add("recall", &P::recall).csv(6);
  return c.table(curve.points);
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
  charts::Page page("Loop closures by visual words");
  page.preformatted(toText(f)).paragraph(kScoreWords);
  charts::Curve curve{"precision over recall", 0, {}};
  for (const auto& p : f.curve.points) curve.points.push_back({100 * p.recall, {100 * p.precision}});
  charts::ChartFrame frame{"Precision and recall", "recall [%]", "precision [%]"};
  frame.yRange = {0.0, 100.0};
  page.figure(charts::curveChart(frame, {curve}), "One point for each score; the surest answers stand left.");
  std::vector<LoopAnswer> accepted;
  for (const auto& a : answers)
    if (a.accepted) accepted.push_back(a);
  page.table(tableOf(accepted).toPage("Accepted answers"));
  page.preformatted(settings, "Configuration");
  return page.html();
}

}  // namespace engram::apps
