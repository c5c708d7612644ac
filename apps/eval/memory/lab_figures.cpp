// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/lab_figures.h"

#include "engram/base/error.h"

#include <functional>
#include <map>

namespace engram::apps {
namespace {

using evaluation::BlockSample;
using evaluation::Interval;

enum class Part { kGlobal, kLocal, kAll };

/// One sample for each image of the part; the stretch of the drive is the block.
std::vector<BlockSample> samplesOf(const std::vector<float>& errors, const std::vector<Sequence>& sequences,
                                   int length, Part part, const std::function<double(double)>& value) {
  std::vector<BlockSample> samples;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const bool first = i % static_cast<std::size_t>(length) == 0;
    if ((part == Part::kGlobal && !first) || (part == Part::kLocal && first)) continue;
    samples.push_back({sequences[i / static_cast<std::size_t>(length)].block, value(errors[i]), 1.0});
  }
  return samples;
}

double succeeded(double error) { return error <= kSuccessDistance ? 1.0 : 0.0; }
double asMeasured(double error) { return error; }

LabFigure figureOf(const MethodRun& run, const Cell& cell, const std::vector<Sequence>& sequences,
                   int length) {
  const auto share = [&](const std::vector<float>& errors, Part part) {
    return evaluation::blockBootstrapShare(samplesOf(errors, sequences, length, part, succeeded));
  };
  const auto mean = [&](Part part) {
    return evaluation::blockBootstrapMean(samplesOf(cell.interpolated, sequences, length, part, asMeasured));
  };
  LabFigure f;
  f.method = run.method;
  f.condition = cell.condition;
  f.update = cell.update;
  f.globalSuccess = share(cell.interpolated, Part::kGlobal);
  f.localSuccess = share(cell.interpolated, Part::kLocal);
  f.globalWhole = share(cell.whole, Part::kGlobal);
  f.localWhole = share(cell.whole, Part::kLocal);
  f.globalError = mean(Part::kGlobal);
  f.localError = mean(Part::kLocal);
  f.error = mean(Part::kAll);
  f.bytesPerPlace = run.updates[static_cast<std::size_t>(cell.update - 1)].holdings.bytesPerPlace;
  return f;
}

const Cell& cellOf(const MethodRun& run, const std::string& condition, int update) {
  for (const Cell& cell : run.cells)
    if (cell.condition == condition && cell.update == update) return cell;
  throw base::Error("the run of " + run.method + " has no figures for " + condition + " at update " +
                    std::to_string(update));
}

}  // namespace

std::vector<LabFigure> figuresOf(const std::vector<MethodRun>& runs, const std::vector<Sequence>& sequences,
                                 int sequenceLength) {
  std::vector<LabFigure> figures;
  for (const MethodRun& run : runs)
    for (const Cell& cell : run.cells) figures.push_back(figureOf(run, cell, sequences, sequenceLength));
  return figures;
}

std::vector<Advantage> advantagesOfFirst(const std::vector<MethodRun>& runs,
                                         const std::vector<Sequence>& sequences, int sequenceLength) {
  const auto samples = [&](const Cell& cell) {
    return samplesOf(cell.interpolated, sequences, sequenceLength, Part::kAll, succeeded);
  };
  std::vector<Advantage> advantages;
  const MethodRun& first = runs.front();
  for (const Cell& cell : first.cells) {
    if (cell.update != first.cells.back().update) continue;
    for (const MethodRun& other : runs) {
      if (&other == &first) continue;
      const Cell& its = cellOf(other, cell.condition, cell.update);
      advantages.push_back(
          {cell.condition, other.method, evaluation::blockBootstrapDifference(samples(cell), samples(its))});
    }
  }
  return advantages;
}

const std::string& inWords(const std::string& condition) {
  static const std::map<std::string, std::string> words{
      {"clean", "images as they are"},
      {"noise", "images with Gaussian noise"},
      {"noise_25", "noise, and 25 % of the features removed"},
      {"noise_50", "noise, and 50 % of the features removed"}};
  return words.at(condition);
}

ResultTable tableOf(const std::vector<LabFigure>& figures) {
  using F = LabFigure;
  constexpr auto kLargest = charts::Best::kLargest, kSmallest = charts::Best::kSmallest;
  Columns<F> c;
  c.add("method", &F::method).csv().json().page("method").text("method", 17);
  c.add("condition", &F::condition).csv().json().text("condition", 9);
  c.add("update", &F::update).csv().json();
  c.add("global_success", &F::globalSuccess)
      .csv(4, "global_low", "global_high")
      .json("", "global_success_95")
      .page("global [%]", percent(1), kLargest)
      .text("global", 22, percent(1));
  c.add("local_success", &F::localSuccess)
      .csv(4, "local_low", "local_high")
      .json("", "local_success_95")
      .page("local [%]", percent(1), kLargest)
      .text("local", 22, percent(1));
  c.add("global_success_whole", &F::globalWhole)
      .csv(4)
      .json()
      .page("global, whole [%]", percent(1), kLargest);
  c.add("local_success_whole", &F::localWhole).csv(4).json().page("local, whole [%]", percent(1), kLargest);
  c.add("mean_error_places", &F::error)
      .csv(4, "mean_error_low", "mean_error_high")
      .json("mean_error", "mean_error_95")
      .page("mean error [places]", fixed(2), kSmallest)
      .text("mean error [places]", 21, fixed(2));
  c.add("global_mean_error_places", &F::globalError).csv(4).json("global_mean_error");
  c.add("local_mean_error_places", &F::localError).csv(4).json("local_mean_error");
  c.add("bytes_per_place", &F::bytesPerPlace)
      .csv()
      .json()
      .page("kB a place", kilo(1), kSmallest)
      .text("kB a place", -7, kilo(1));
  return c.table(figures);
}

ResultTable tableOf(const std::vector<Advantage>& advantages) {
  Columns<Advantage> c;
  c.add("condition", &Advantage::condition).json();
  c.add("", [](const Advantage& a) { return inWords(a.condition); }).page("condition");
  c.add("over", &Advantage::over).json().page("over");
  c.add("points", &Advantage::share).json("", "points_95").page("points", percent(1));
  return c.table(advantages);
}

}  // namespace engram::apps
