// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/lab_figures.h"

#include "engram/base/error.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <functional>

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
double itself(double error) { return error; }

LabFigure figureOf(const MethodRun& run, const Cell& cell, const std::vector<Sequence>& sequences,
                   int length) {
  const auto share = [&](const std::vector<float>& errors, Part part) {
    return evaluation::blockBootstrapShare(samplesOf(errors, sequences, length, part, succeeded));
  };
  const auto mean = [&](Part part) {
    return evaluation::blockBootstrapMean(samplesOf(cell.interpolated, sequences, length, part, itself));
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

nlohmann::json bounds(const Interval& i) { return {i.low, i.high}; }

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

nlohmann::json toJson(const std::vector<LabFigure>& figures) {
  nlohmann::json list = nlohmann::json::array();
  for (const auto& f : figures)
    list.push_back({{"method", f.method},
                    {"condition", f.condition},
                    {"update", f.update},
                    {"global_success", f.globalSuccess.value},
                    {"global_success_95", bounds(f.globalSuccess)},
                    {"local_success", f.localSuccess.value},
                    {"local_success_95", bounds(f.localSuccess)},
                    {"global_success_whole", f.globalWhole.value},
                    {"local_success_whole", f.localWhole.value},
                    {"mean_error", f.error.value},
                    {"mean_error_95", bounds(f.error)},
                    {"global_mean_error", f.globalError.value},
                    {"local_mean_error", f.localError.value},
                    {"bytes_per_place", f.bytesPerPlace}});
  return list;
}

nlohmann::json toJson(const std::vector<Advantage>& advantages) {
  nlohmann::json list = nlohmann::json::array();
  for (const auto& a : advantages)
    list.push_back({{"condition", a.condition},
                    {"over", a.over},
                    {"points", a.share.value},
                    {"points_95", bounds(a.share)}});
  return list;
}

std::string toCsv(const std::vector<LabFigure>& figures) {
  std::string csv =
      "method,condition,update,global_success,global_low,global_high,local_success,local_low,local_high,"
      "global_success_whole,local_success_whole,mean_error_places,mean_error_low,mean_error_high,"
      "global_mean_error_places,local_mean_error_places,bytes_per_place\n";
  char line[512];
  for (const auto& f : figures) {
    std::snprintf(line, sizeof line,
                  "%s,%s,%d,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.0f\n",
                  f.method.c_str(), f.condition.c_str(), f.update, f.globalSuccess.value, f.globalSuccess.low,
                  f.globalSuccess.high, f.localSuccess.value, f.localSuccess.low, f.localSuccess.high,
                  f.globalWhole.value, f.localWhole.value, f.error.value, f.error.low, f.error.high,
                  f.globalError.value, f.localError.value, f.bytesPerPlace);
    csv += line;
  }
  return csv;
}

}  // namespace engram::apps
