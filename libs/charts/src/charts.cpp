// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/charts/charts.h"

#include "engram/base/error.h"
#include "engram/charts/drawing.h"
#include "engram/charts/markup.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace engram::charts {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The smallest range that holds all finite values it was given.
struct Extent {
  double low = kInfinity, high = -kInfinity;

  void add(double v) {
    if (!std::isfinite(v)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  void add(const Estimate& e) {
    if (!std::isfinite(e.value)) return;
    add(e.value);
    add(e.low);
    add(e.high);
  }
  bool empty() const { return !(low <= high); }
};

bool hasInterval(const Estimate& e) {
  return std::isfinite(e.value) && std::isfinite(e.low) && std::isfinite(e.high);
}

std::string noValues(const ChartFrame& frame) { return "<p>" + escaped(frame.title) + ": no values.</p>\n"; }

std::string tooltip(const std::string& label, const std::string& where, const Estimate& e) {
  std::string out = label + ", " + where + ": " + number(e.value);
  if (hasInterval(e)) out += " (" + number(e.low) + " to " + number(e.high) + ")";
  return out;
}

/// What the frame asks for, widened to the values; without a wish the round numbers around the values, with 0
/// when it is near.
Extent yExtent(const ChartFrame& frame, Extent values, bool withZero) {
  if (frame.yRange) {
    Extent out{frame.yRange->first, frame.yRange->second};
    out.add(values.low);
    out.add(values.high);
    return out;
  }
  if (withZero || (values.low > 0 && values.low < 0.4 * values.high)) values.add(0.0);
  if (!(values.high > values.low)) values.high += values.high == 0 ? 1 : std::abs(values.high) * 0.1;
  const double step = tickStep(values.low, values.high, 5);
  return {std::floor(values.low / step + 1e-9) * step, std::ceil(values.high / step - 1e-9) * step};
}

std::vector<LegendEntry> markerLegend(const std::vector<Curve>& curves) {
  std::vector<LegendEntry> out;
  for (const Curve& c : curves) out.push_back({c.label, styleColour(c.style), LegendKey::kMarker, c.style});
  return out;
}

/// The x that were measured, when there are few enough to label each.
std::vector<double> measuredTicks(const std::vector<Curve>& curves, double pixels, const Extent& range) {
  std::set<double> all;
  for (const Curve& c : curves)
    for (const CurvePoint& p : c.points)
      if (std::isfinite(p.x)) all.insert(p.x);
  const std::vector<double> ticks(all.begin(), all.end());
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    const double gap = (ticks[i] - ticks[i - 1]) / (range.high - range.low) * pixels;
    if (gap < 8 + (textWidth(number(ticks[i]), 12) + textWidth(number(ticks[i - 1]), 12)) / 2) return {};
  }
  return ticks;
}

void drawBand(Drawing& drawing, const Curve& curve) {
  std::vector<Eigen::Vector2d> low, high;
  const auto flush = [&] {
    if (low.size() > 1) drawing.band(low, high, styleColour(curve.style));
    low.clear();
    high.clear();
  };
  for (const CurvePoint& p : curve.points) {
    if (!hasInterval(p.y)) {
      flush();
      continue;
    }
    low.emplace_back(p.x, p.y.low);
    high.emplace_back(p.x, p.y.high);
  }
  flush();
}

void drawCurve(Drawing& drawing, const Curve& curve, double shift, bool errorBars) {
  const Colour colour = styleColour(curve.style);
  std::vector<Eigen::Vector2d> line;
  const auto flush = [&] {
    if (line.size() > 1) drawing.polyline(line, colour, 1.6);
    line.clear();
  };
  for (const CurvePoint& p : curve.points) {
    if (std::isfinite(p.x) && std::isfinite(p.y.value))
      line.emplace_back(p.x + shift, p.y.value);
    else
      flush();
  }
  flush();
  for (const CurvePoint& p : curve.points) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y.value)) continue;
    if (errorBars && hasInterval(p.y)) drawing.errorBar(p.x + shift, p.y.low, p.y.high, colour);
    drawing.marker({p.x + shift, p.y.value}, curve.style, tooltip(curve.label, number(p.x), p.y));
  }
}

/// The steps of a cumulative distribution, without those that no pixel shows.
std::vector<Eigen::Vector2d> steps(const std::vector<double>& sorted, double total, double pixel, double from,
                                   double to) {
  std::vector<Eigen::Vector2d> out{{from, 0}};
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const bool last = i + 1 == sorted.size();
    if (!last && (sorted[i + 1] == sorted[i] || sorted[i + 1] - out.back().x() < 0.5 * pixel)) continue;
    const double share = 100 * static_cast<double>(i + 1) / total;
    out.emplace_back(sorted[i], out.back().y());
    out.emplace_back(sorted[i], share);
  }
  out.emplace_back(to, out.back().y());
  return out;
}

struct Sorted {
  std::vector<double> finite;
  double total = 0;
};

Sorted sortedValues(const Distribution& d) {
  Sorted out;
  for (const double v : d.values) {
    if (std::isnan(v)) continue;
    ++out.total;
    if (std::isfinite(v)) out.finite.push_back(v);
  }
  std::sort(out.finite.begin(), out.finite.end());
  return out;
}

std::string shareUnder(const Sorted& values, double x) {
  if (values.total == 0) return "no values";
  const auto n = std::lower_bound(values.finite.begin(), values.finite.end(), x) - values.finite.begin();
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %% under", 100 * static_cast<double>(n) / values.total);
  return text;
}

void drawCumulative(Drawing& drawing, const Distribution& d, const Sorted& values, const Extent& xs) {
  drawing.polyline(steps(values.finite, values.total, drawing.pixel(), xs.low, xs.high), styleColour(d.style),
                   1.6);
  constexpr int kMarkers = 8;
  for (int k = 0; k < kMarkers; ++k) {
    const auto i = static_cast<std::size_t>((k + 0.5) / kMarkers * static_cast<double>(values.finite.size()));
    const double x = values.finite[i];
    const auto upTo = std::upper_bound(values.finite.begin(), values.finite.end(), x) - values.finite.begin();
    const double share = 100 * static_cast<double>(upTo) / values.total;
    drawing.marker({x, share}, d.style, d.label + ": " + number(share, 3) + " % up to " + number(x));
  }
}

}  // namespace

std::string curveChart(const ChartFrame& frame, const std::vector<Curve>& curves, Spread spread) {
  Extent xs, ys;
  bool intervals = false;
  for (const Curve& c : curves)
    for (const CurvePoint& p : c.points) {
      if (!std::isfinite(p.x) || !std::isfinite(p.y.value)) continue;
      xs.add(p.x);
      ys.add(p.y);
      intervals = intervals || hasInterval(p.y);
    }
  if (ys.empty()) return noValues(frame);
  const double margin = xs.high > xs.low ? 0.04 * (xs.high - xs.low) : 0.5;
  xs = {xs.low - margin, xs.high + margin};
  ys = yExtent(frame, ys, false);
  const auto ticks = measuredTicks(curves, frame.width - 90, xs);
  Drawing drawing(
      frame,
      {.low = {xs.low, ys.low}, .high = {xs.high, ys.high}, .xTicks = ticks, .legend = markerLegend(curves)});
  const bool bars = spread == Spread::kBars && intervals;
  if (spread == Spread::kBands)
    for (const Curve& c : curves) drawBand(drawing, c);
  const double apart = bars && !ticks.empty() ? 4 * drawing.pixel() : 0;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const double shift = (static_cast<double>(i) - static_cast<double>(curves.size() - 1) / 2) * apart;
    drawCurve(drawing, curves[i], shift, bars);
  }
  return std::move(drawing).finish();
}

std::string pathChart(const ChartFrame& frame, const std::vector<Curve>& paths,
                      const std::vector<Curve>& marks) {
  Extent xs, ys;
  std::vector<LegendEntry> legend = markerLegend(marks);
  for (const auto* curves : {&paths, &marks})
    for (const Curve& c : *curves)
      for (const CurvePoint& p : c.points) {
        if (!std::isfinite(p.x) || !std::isfinite(p.y.value)) continue;
        xs.add(p.x);
        ys.add(p.y.value);
      }
  if (ys.empty()) return noValues(frame);
  for (std::size_t i = 0; i < paths.size(); ++i)
    legend.insert(legend.begin() + static_cast<std::ptrdiff_t>(i),
                  {paths[i].label, styleColour(paths[i].style), LegendKey::kLine});
  const double margin = 0.04 * std::max({xs.high - xs.low, ys.high - ys.low, 1.0});
  Drawing drawing(frame, {.low = {xs.low - margin, ys.low - margin},
                          .high = {xs.high + margin, ys.high + margin},
                          .equalScale = true,
                          .legend = legend});
  for (const Curve& c : paths) {
    std::vector<Eigen::Vector2d> line;
    for (const CurvePoint& p : c.points)
      if (std::isfinite(p.x) && std::isfinite(p.y.value)) line.emplace_back(p.x, p.y.value);
    drawing.polyline(line, styleColour(c.style), 1.6);
  }
  for (const Curve& c : marks)
    for (const CurvePoint& p : c.points)
      if (std::isfinite(p.x) && std::isfinite(p.y.value))
        drawing.marker({p.x, p.y.value}, c.style, c.label + ": " + number(p.x) + ", " + number(p.y.value));
  return std::move(drawing).finish();
}

std::string barChart(const ChartFrame& frame, const std::vector<std::string>& groups,
                     const std::vector<BarSeries>& series) {
  Extent ys;
  std::vector<LegendEntry> legend;
  for (const BarSeries& s : series) {
    if (s.values.size() != groups.size())
      throw base::Error("bar chart \"" + frame.title + "\": series \"" + s.label + "\" has " +
                        std::to_string(s.values.size()) + " values for " + std::to_string(groups.size()) +
                        " groups; give one a group, NaN where there is none");
    for (const Estimate& e : s.values) ys.add(e);
    legend.push_back({s.label, styleColour(s.style), LegendKey::kSwatch});
  }
  if (ys.empty()) return noValues(frame);
  ys = yExtent(frame, ys, true);
  ys.add(0.0);
  Drawing drawing(frame, {.low = {-0.5, ys.low},
                          .high = {static_cast<double>(groups.size()) - 0.5, ys.high},
                          .groups = groups,
                          .legend = legend});
  const double slot = 0.8 / static_cast<double>(series.size());
  for (std::size_t s = 0; s < series.size(); ++s)
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const Estimate& e = series[s].values[g];
      const double from = static_cast<double>(g) - 0.4 + slot * static_cast<double>(s);
      if (!std::isfinite(e.value)) {
        drawing.words({from + slot / 2 - 10 * drawing.pixel(), 0}, "–", 12);
        continue;
      }
      drawing.bar({from + 0.04 * slot, std::min(0.0, e.value)}, {from + 0.96 * slot, std::max(0.0, e.value)},
                  styleColour(series[s].style), tooltip(series[s].label, groups[g], e));
      if (hasInterval(e)) drawing.errorBar(from + slot / 2, e.low, e.high, {20, 20, 20}, true);
    }
  return std::move(drawing).finish();
}

std::string cumulativeChart(const ChartFrame& frame, const std::vector<Distribution>& series,
                            const std::optional<Threshold>& threshold) {
  Extent xs;
  std::vector<Sorted> sorted;
  std::vector<LegendEntry> legend;
  for (const Distribution& d : series) {
    sorted.push_back(sortedValues(d));
    for (const double v : sorted.back().finite) xs.add(v);
    legend.push_back({d.label, styleColour(d.style), LegendKey::kMarker, d.style});
    if (threshold) legend.back().label += ": " + shareUnder(sorted.back(), threshold->x);
  }
  if (xs.empty()) return noValues(frame);
  constexpr Colour kGrey{70, 70, 70};
  if (threshold) {
    xs.add(threshold->x);
    legend.push_back({threshold->label, kGrey, LegendKey::kDashed});
  }
  if (xs.low > 0 && xs.low < 0.4 * xs.high) xs.add(0.0);
  xs.high += xs.high > xs.low ? 0.02 * (xs.high - xs.low) : 1;
  Drawing drawing(frame, {.low = {xs.low, 0}, .high = {xs.high, 100}, .legend = legend});
  if (threshold) drawing.line({threshold->x, 0}, {threshold->x, 100}, kGrey, 1.4, true);
  for (std::size_t s = 0; s < series.size(); ++s)
    if (!sorted[s].finite.empty()) drawCumulative(drawing, series[s], sorted[s], xs);
  return std::move(drawing).finish();
}

std::string histogram(const ChartFrame& frame, const std::vector<Distribution>& series, int bins) {
  Extent xs;
  for (const Distribution& s : series)
    for (const double v : s.values) xs.add(v);
  if (xs.empty()) return noValues(frame);
  const double low = std::min(xs.low, 0.0);
  const double step = xs.high > low ? (xs.high - low) / bins : 1;
  std::vector<std::vector<int>> counts(series.size(), std::vector<int>(static_cast<std::size_t>(bins), 0));
  int most = 1;
  for (std::size_t s = 0; s < series.size(); ++s)
    for (const double v : series[s].values) {
      if (!std::isfinite(v)) continue;
      const auto bin =
          std::min(static_cast<std::size_t>((v - low) / step), static_cast<std::size_t>(bins) - 1);
      most = std::max(most, ++counts[s][bin]);
    }
  std::vector<LegendEntry> legend;
  if (series.size() > 1)
    for (const Distribution& s : series)
      legend.push_back({s.label, styleColour(s.style), LegendKey::kSwatch});
  Drawing drawing(frame, {.low = {low, 0}, .high = {low + step * bins, most * 1.05}, .legend = legend});
  for (std::size_t s = 0; s < series.size(); ++s) {
    const double share = 0.9 / static_cast<double>(series.size());
    for (std::size_t b = 0; b < counts[s].size(); ++b) {
      if (counts[s][b] == 0) continue;
      const double from = low + step * (static_cast<double>(b) + 0.05 + share * static_cast<double>(s));
      const double edge = low + step * static_cast<double>(b);
      drawing.bar({from, 0}, {from + share * step, counts[s][b]}, styleColour(series[s].style),
                  series[s].label + ", " + number(edge, 3) + " to " + number(edge + step, 3) + ": " +
                      std::to_string(counts[s][b]));
    }
  }
  return std::move(drawing).finish();
}

std::string timeline(const ChartFrame& frame, const std::vector<Distribution>& series) {
  constexpr std::size_t kMaxPoints = 600;
  std::size_t longest = 0;
  double high = 0;
  std::vector<LegendEntry> legend;
  for (const Distribution& s : series) {
    longest = std::max(longest, s.values.size());
    for (const double v : s.values)
      if (std::isfinite(v)) high = std::max(high, v);
    if (series.size() > 1) legend.push_back({s.label, styleColour(s.style)});
  }
  if (longest == 0) return noValues(frame);
  const auto last = static_cast<double>(std::max<std::size_t>(longest - 1, 1));
  Drawing drawing(frame, {.low = {0, 0}, .high = {last, high > 0 ? high * 1.05 : 1}, .legend = legend});
  const std::size_t bin = longest / kMaxPoints + 1;
  for (const Distribution& s : series) {
    std::vector<Eigen::Vector2d> points;
    for (std::size_t i = 0; i < s.values.size(); i += bin) {
      Extent here;
      for (std::size_t k = i; k < std::min(i + bin, s.values.size()); ++k) here.add(s.values[k]);
      if (!here.empty()) points.emplace_back(static_cast<double>(i), here.high);
    }
    drawing.polyline(points, styleColour(s.style), 1.2);
  }
  return std::move(drawing).finish();
}

}  // namespace engram::charts
