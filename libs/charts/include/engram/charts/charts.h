// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Charts as SVG text. Each is a document of its own (write it to a .svg file) and may stand inside a page
/// (see page.h). A series has a style: one of eight colours that colour-blind eyes tell apart, and a marker;
/// equal styles look equal in all charts. A chart without any value is a sentence instead.
namespace engram::charts {

/// Words and size of a chart.
struct ChartFrame {
  std::string title = {};
  std::string xLabel = {};  ///< with its unit: "time [s]"
  std::string yLabel = {};
  double width = 550;  ///< of the whole picture [px]
  double height = 340;
  /// Of curves and bars, shown at least; values and intervals beyond it widen it, so that none is hidden.
  /// None: fits the values.
  std::optional<std::pair<double, double>> yRange = std::nullopt;
};

/// A value with the ends of its interval. An end that is not finite draws no error bar.
struct Estimate {
  double value = 0;
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};

struct CurvePoint {
  double x = 0;
  Estimate y = {};  ///< a value that is not finite interrupts the line
};

struct Curve {
  std::string label = {};
  int style = 0;
  std::vector<CurvePoint> points = {};
};

enum class Spread {
  kBars,   ///< error bars; series stand up to a few pixels beside each other, so that bars do not cover bars
  kBands,  ///< shaded bands; for few series with many points
};

/// Lines with markers at given x.
std::string curveChart(const ChartFrame& frame, const std::vector<Curve>& curves,
                       Spread spread = Spread::kBars);

/// Ways in the plane as lines, one unit as long in x as in y. `marks` are points beside them.
std::string pathChart(const ChartFrame& frame, const std::vector<Curve>& paths,
                      const std::vector<Curve>& marks = {});

struct BarSeries {
  std::string label = {};
  int style = 0;
  std::vector<Estimate> values = {};  ///< one a group; not finite: "–" instead of a bar
};

/// Bars with error bars, side by side in named groups. Throws base::Error when a series has not one value a
/// group.
std::string barChart(const ChartFrame& frame, const std::vector<std::string>& groups,
                     const std::vector<BarSeries>& series);

struct Distribution {
  std::string label = {};
  int style = 0;
  std::vector<double> values = {};
};

/// A vertical line across a cumulative chart; the legend then tells the share of each series under it.
struct Threshold {
  double x = 0;
  std::string label = {};
};

/// Share of the values up to x, in per cent. +∞ (never found) counts and keeps a curve below 100 %; NaN is
/// left out.
std::string cumulativeChart(const ChartFrame& frame, const std::vector<Distribution>& series,
                            const std::optional<Threshold>& threshold = std::nullopt);

/// Counts of values, bars side by side.
std::string histogram(const ChartFrame& frame, const std::vector<Distribution>& series, int bins);

/// Values over their index. Long series are drawn as the largest value of each bin of neighbours.
std::string timeline(const ChartFrame& frame, const std::vector<Distribution>& series);

}  // namespace engram::charts
