// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tours/tours_figures.h"

#include <algorithm>
#include <functional>
#include <limits>

namespace engram::apps {
namespace {

using evaluation::BlockSample;
using evaluation::Interval;
using Ask = std::function<double(const TourQuery&)>;

std::vector<BlockSample> samplesOf(const ToursRun& run, const Ask& value) {
  std::vector<BlockSample> samples;
  for (const TourRecord& tour : run.tours)
    for (const TourQuery& query : tour.queries) samples.push_back({tour.tour, value(query), 1.0});
  return samples;
}

std::vector<double> valuesOf(const std::vector<BlockSample>& samples) {
  std::vector<double> values;
  for (const auto& s : samples) values.push_back(s.value);
  return values;
}

/// What is asked of each image.
struct Questions {
  Ask failed, strict, few, fewVerified, matched, verified, learnt, learntWrong;
};

Questions questionsOf(const ToursRun& run, int fewMatches) {
  const TourPlaces truth = run.truth();
  Questions q;
  q.failed = [=](const TourQuery& i) { return truth.brackets(i.winner, i.arc) ? 0.0 : 1.0; };
  q.strict = [=](const TourQuery& i) { return truth.nearest(i.arc) == i.winner ? 0.0 : 1.0; };
  q.few = [=](const TourQuery& i) { return i.matched < fewMatches ? 1.0 : 0.0; };
  q.fewVerified = [=](const TourQuery& i) { return i.verified < fewMatches ? 1.0 : 0.0; };
  q.matched = [](const TourQuery& i) { return static_cast<double>(i.matched); };
  q.verified = [](const TourQuery& i) { return static_cast<double>(i.verified); };
  q.learnt = [](const TourQuery& i) { return i.learnt ? 1.0 : 0.0; };
  q.learntWrong = [failed = q.failed](const TourQuery& i) { return i.learnt ? failed(i) : 0.0; };
  return q;
}

double sumOf(const std::vector<BlockSample>& samples) {
  double sum = 0;
  for (const auto& s : samples) sum += s.value;
  return sum;
}

ToursFigure figureOf(const ToursRun& run, const ToursRun* baseline, int fewMatches) {
  const Questions q = questionsOf(run, fewMatches);
  const auto share = [&](const Ask& value) { return evaluation::blockBootstrapShare(samplesOf(run, value)); };
  ToursFigure f;
  f.method = run.method;
  const auto matched = samplesOf(run, q.matched);
  f.queries = static_cast<int>(matched.size());
  f.failure = share(q.failed);
  f.strict = share(q.strict);
  f.few = share(q.few);
  f.fewVerified = share(q.fewVerified);
  f.matched = meanAndSigma(valuesOf(matched));
  f.verified = meanAndSigma(valuesOf(samplesOf(run, q.verified)));
  const double learnt = sumOf(samplesOf(run, q.learnt));
  f.learnt = learnt / std::max(1, f.queries);
  f.learntWrong = sumOf(samplesOf(run, q.learntWrong)) / std::max(1.0, learnt);
  for (const auto& s : matched) {
    const auto n = static_cast<std::size_t>(s.value);
    if (f.histogram.size() <= n) f.histogram.resize(n + 1, 0);
    ++f.histogram[n];
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  f.failureOver = f.fewOver = {nan, nan, nan};
  if (baseline) {
    f.failureOver =
        evaluation::blockBootstrapDifference(samplesOf(run, q.failed), samplesOf(*baseline, q.failed));
    f.fewOver = evaluation::blockBootstrapDifference(samplesOf(run, q.few), samplesOf(*baseline, q.few));
  }
  return f;
}

std::string percentages(const Interval& i) {
  return line("%5.1f [%5.1f, %5.1f]", 100 * i.value, 100 * i.low, 100 * i.high);
}

std::string plusMinus(const MeanSigma& m) { return line("%5.1f +- %5.1f", m.mean, m.sigma); }

Spread spreadOf(const ToursRun& run, const Ask& ask) {
  const MeanSigma m = meanAndSigma(valuesOf(samplesOf(run, ask)));
  return {m.mean, m.sigma};
}

double featuresOf(const TourQuery& i) { return i.features; }

/// One tour of one method.
struct OneTour {
  ToursRun run;
  Questions asked;

  const TourRecord& tour() const { return run.tours.front(); }
  int count(const Ask& ask) const { return static_cast<int>(sumOf(samplesOf(run, ask))); }
};

std::vector<OneTour> tourByTour(const std::vector<ToursRun>& runs, int fewMatches) {
  std::vector<OneTour> tours;
  for (const ToursRun& run : runs) {
    const Questions q = questionsOf(run, fewMatches);
    for (const TourRecord& tour : run.tours)
      tours.push_back({{run.method, run.tourLength, run.placeArcs, {tour}}, q});
  }
  return tours;
}

}  // namespace

std::vector<ToursFigure> figuresOf(const std::vector<ToursRun>& runs, int fewMatches,
                                   const std::string& baseline) {
  const auto base =
      std::find_if(runs.begin(), runs.end(), [&](const ToursRun& run) { return run.method == baseline; });
  std::vector<ToursFigure> figures;
  for (const ToursRun& run : runs)
    figures.push_back(figureOf(run, base == runs.end() ? nullptr : &*base, fewMatches));
  return figures;
}

ResultTable tableOf(const std::vector<ToursFigure>& figures, int fewMatches) {
  using F = ToursFigure;
  constexpr auto kSmallest = charts::Best::kSmallest;
  const std::string under = "under " + std::to_string(fewMatches);
  Columns<F> c;
  c.add("method", &F::method).json().page("method").text("method", 16);
  c.add("queries", &F::queries).json();
  c.add("failure_rate", &F::failure)
      .json("", "failure_rate_95")
      .page("failure [%]", percent(1), kSmallest)
      .text("failure [%]", 21, percent(1));
  c.add("failure_rate_strict", &F::strict)
      .json("", "failure_rate_strict_95")
      .page("not the nearest [%]", percent(1), kSmallest)
      .text("not the nearest [%]", 21, percent(1));
  c.add("share_under_35", &F::few)
      .json("", "share_under_35_95")
      .page(under + " points [%]", percent(1), kSmallest)
      .text(under + " matched [%]", 21, percent(1));
  c.add("share_under_35_verified", &F::fewVerified).json("", "share_under_35_verified_95");
  c.add("mean_matched", [](const F& f) { return f.matched.mean; }).json().page("points, mean", fixed(1));
  c.add("sd_matched", [](const F& f) { return f.matched.sigma; }).json();
  c.add("", [](const F& f) { return plusMinus(f.matched); }).text("matched", 16);
  c.add("mean_verified", [](const F& f) { return f.verified.mean; }).json();
  c.add("sd_verified", [](const F& f) { return f.verified.sigma; }).json();
  c.add("", [](const F& f) { return plusMinus(f.verified); }).text("verified", 16);
  c.add("share_learnt", &F::learnt).json().page("learnt from [%]", percent(1));
  c.add("share_learnt_wrong", &F::learntWrong).json().page("of these wrong [%]", percent(1));
  c.add("", [](const F& f) {
     return line("%5.1f (%.1f)", 100 * f.learnt, 100 * f.learntWrong);
   }).text("learnt (wrong) [%]", 0);
  c.add("failure_rate_over_static", &F::failureOver).json("", "failure_rate_over_static_95");
  c.add("share_under_35_over_static", &F::fewOver).json("", "share_under_35_over_static_95");
  c.add("matched_histogram", [](const F& f) { return nlohmann::json(f.histogram); }).json();
  return c.table(figures);
}

std::string toCsv(const std::vector<ToursRun>& runs, int fewMatches) {
  using T = OneTour;
  Columns<T> c;
  const auto counted = [&c](const std::string& name, Ask Questions::*ask) {
    c.add(name, [ask](const T& t) { return t.count(t.asked.*ask); }).csv();
  };
  const auto spread = [&c](const std::string& name, auto of, int decimals) {
    c.add(name + "_mean", of).csv(decimals, name + "_sd");
  };
  c.add("method", [](const T& t) { return t.run.method; }).csv();
  c.add("tour", [](const T& t) { return t.tour().tour; }).csv();
  c.add("day", [](const T& t) { return t.tour().day; }).csv();
  c.add("images", [](const T& t) { return t.tour().queries.size(); }).csv();
  counted("failures", &Questions::failed);
  counted("failures_strict", &Questions::strict);
  counted("few_matched", &Questions::few);
  counted("few_verified", &Questions::fewVerified);
  spread(
      "matched", [](const T& t) { return spreadOf(t.run, t.asked.matched); }, 2);
  spread(
      "verified", [](const T& t) { return spreadOf(t.run, t.asked.verified); }, 2);
  spread(
      "features", [](const T& t) { return spreadOf(t.run, featuresOf); }, 2);
  counted("learnt", &Questions::learnt);
  counted("learnt_wrong", &Questions::learntWrong);
  const auto held = [](const T& t) -> const Holdings& { return t.tour().holdings; };
  spread(
      "ltm",
      [held](const T& t) {
        return Spread{held(t).longTerm, held(t).longTermSigma};
      },
      1);
  spread(
      "stm",
      [held](const T& t) {
        return Spread{held(t).shortTerm, held(t).shortTermSigma};
      },
      1);
  c.add("bytes_per_place", [held](const T& t) { return held(t).bytesPerPlace; }).csv();
  return c.table(tourByTour(runs, fewMatches)).toCsv();
}

std::string toText(const std::vector<ToursFigure>& figures, const std::vector<ToursRun>& runs,
                   int fewMatches) {
  const ToursRun& any = runs.front();
  const Spread features = spreadOf(any, featuresOf);
  std::string text = line(
      "%zu tours over %.0f days, %d images with %.1f +- %.1f features, %zu places from the tour "
      "before them\n",
      any.tours.size(), any.tours.back().day, figures.front().queries, features.mean, features.sigma,
      any.placeArcs.size());
  text += tableOf(figures, fewMatches).toText();
  text +=
      "paper, adaptive    1.5                  -                     24\n"
      "paper, static      3.5                  -                     43\n";
  for (const auto& f : figures) {
    if (f.method == "static" || !f.failureOver.known()) continue;
    text += line("%-16s less static, in points: failure %s, under %d matched %s\n", f.method.c_str(),
                 percentages(f.failureOver).c_str(), fewMatches, percentages(f.fewOver).c_str());
  }
  return text;
}

}  // namespace engram::apps
