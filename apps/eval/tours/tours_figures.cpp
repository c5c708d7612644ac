// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tours/tours_figures.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <limits>

namespace engram::apps {
namespace {

using evaluation::BlockSample;
using evaluation::Interval;
using Value = std::function<double(const TourQuery&)>;

std::vector<BlockSample> samplesOf(const ToursRun& run, const Value& value) {
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
  Value failed, strict, few, fewVerified, matched, verified, learnt, learntWrong;
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
  const auto share = [&](const Value& value) {
    return evaluation::blockBootstrapShare(samplesOf(run, value));
  };
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

nlohmann::json bounds(const Interval& i) { return {i.low, i.high}; }

std::string percent(const Interval& i) {
  char text[64];
  std::snprintf(text, sizeof text, "%5.1f [%5.1f, %5.1f]", 100 * i.value, 100 * i.low, 100 * i.high);
  return text;
}

std::string plusMinus(const MeanSigma& m) {
  char text[48];
  std::snprintf(text, sizeof text, "%5.1f +- %5.1f", m.mean, m.sigma);
  return text;
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

nlohmann::json toJson(const std::vector<ToursFigure>& figures) {
  nlohmann::json list = nlohmann::json::array();
  for (const auto& f : figures)
    list.push_back({{"method", f.method},
                    {"queries", f.queries},
                    {"failure_rate", f.failure.value},
                    {"failure_rate_95", bounds(f.failure)},
                    {"failure_rate_strict", f.strict.value},
                    {"failure_rate_strict_95", bounds(f.strict)},
                    {"share_under_35", f.few.value},
                    {"share_under_35_95", bounds(f.few)},
                    {"share_under_35_verified", f.fewVerified.value},
                    {"share_under_35_verified_95", bounds(f.fewVerified)},
                    {"mean_matched", f.matched.mean},
                    {"sd_matched", f.matched.sigma},
                    {"mean_verified", f.verified.mean},
                    {"sd_verified", f.verified.sigma},
                    {"share_learnt", f.learnt},
                    {"share_learnt_wrong", f.learntWrong},
                    {"failure_rate_over_static", f.failureOver.value},
                    {"failure_rate_over_static_95", bounds(f.failureOver)},
                    {"share_under_35_over_static", f.fewOver.value},
                    {"share_under_35_over_static_95", bounds(f.fewOver)},
                    {"matched_histogram", f.histogram}});
  return list;
}

std::string toCsv(const std::vector<ToursRun>& runs, int fewMatches) {
  std::string csv =
      "method,tour,day,images,failures,failures_strict,few_matched,few_verified,matched_mean,matched_sd,"
      "verified_mean,verified_sd,features_mean,features_sd,learnt,learnt_wrong,ltm_mean,ltm_sd,stm_mean,"
      "stm_sd,bytes_per_place\n";
  char line[512];
  for (const ToursRun& run : runs) {
    const Questions q = questionsOf(run, fewMatches);
    for (const TourRecord& tour : run.tours) {
      const ToursRun one{run.method, run.tourLength, run.placeArcs, {tour}};
      const auto count = [&](const Value& value) { return static_cast<int>(sumOf(samplesOf(one, value))); };
      const auto spread = [&](const Value& value) { return meanAndSigma(valuesOf(samplesOf(one, value))); };
      const MeanSigma matched = spread(q.matched), verified = spread(q.verified);
      const MeanSigma features = spread([](const TourQuery& i) { return static_cast<double>(i.features); });
      const Holdings& h = tour.holdings;
      std::snprintf(line, sizeof line,
                    "%s,%d,%.0f,%zu,%d,%d,%d,%d,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%d,%d,%.1f,%.1f,%.1f,%.1f,"
                    "%.0f\n",
                    run.method.c_str(), tour.tour, tour.day, tour.queries.size(), count(q.failed),
                    count(q.strict), count(q.few), count(q.fewVerified), matched.mean, matched.sigma,
                    verified.mean, verified.sigma, features.mean, features.sigma, count(q.learnt),
                    count(q.learntWrong), h.longTerm, h.longTermSigma, h.shortTerm, h.shortTermSigma,
                    h.bytesPerPlace);
      csv += line;
    }
  }
  return csv;
}

std::string toText(const std::vector<ToursFigure>& figures, const std::vector<ToursRun>& runs,
                   int fewMatches) {
  char line[320];
  const ToursRun& any = runs.front();
  const MeanSigma features = meanAndSigma(
      valuesOf(samplesOf(any, [](const TourQuery& i) { return static_cast<double>(i.features); })));
  std::snprintf(line, sizeof line,
                "%zu tours over %.0f days, %d images with %.1f +- %.1f features, %zu places from the tour "
                "before them\n",
                any.tours.size(), any.tours.back().day, figures.front().queries, features.mean,
                features.sigma, any.placeArcs.size());
  std::string text = line;
  const std::string few = "under " + std::to_string(fewMatches) + " matched [%]";
  std::snprintf(line, sizeof line, "%-16s %-21s %-21s %-21s %-16s %-16s %s\n", "method", "failure [%]",
                "not the nearest [%]", few.c_str(), "matched", "verified", "learnt (wrong) [%]");
  text += line;
  for (const auto& f : figures) {
    std::snprintf(line, sizeof line, "%-16s %s  %s  %s  %s   %s   %5.1f (%.1f)\n", f.method.c_str(),
                  percent(f.failure).c_str(), percent(f.strict).c_str(), percent(f.few).c_str(),
                  plusMinus(f.matched).c_str(), plusMinus(f.verified).c_str(), 100 * f.learnt,
                  100 * f.learntWrong);
    text += line;
  }
  text +=
      "paper, adaptive    1.5                  -                     24                    98.8 +-  18.7\n"
      "paper, static      3.5                  -                     43                    45.2 +-  25.4\n";
  for (const auto& f : figures) {
    if (f.method == "static" || !f.failureOver.known()) continue;
    std::snprintf(line, sizeof line, "%-16s less static, in points: failure %s, under %d matched %s\n",
                  f.method.c_str(), percent(f.failureOver).c_str(), fewMatches, percent(f.fewOver).c_str());
    text += line;
  }
  return text;
}

}  // namespace engram::apps
