// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "charts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace engram::exporters {
namespace {

std::string px(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

std::string attribute(const char* name, const std::string& value) {
  std::string out = " ";
  out.append(name).append("=\"").append(value).append("\"");
  return out;
}

/// Length of the UTF-8 sequence at `i`, 0 when it is not valid.
std::size_t utf8Length(const std::string& text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
  const unsigned first = byte(i);
  const std::size_t n = first < 0x80                    ? 1
                        : first >= 0xC2 && first < 0xE0 ? 2
                        : first >= 0xE0 && first < 0xF0 ? 3
                        : first >= 0xF0 && first < 0xF5 ? 4
                                                        : 0;
  for (std::size_t k = 1; k < n; ++k)
    if ((byte(i + k) & 0xC0) != 0x80) return 0;
  if ((first == 0xE0 && byte(i + 1) < 0xA0) || (first == 0xED && byte(i + 1) >= 0xA0) ||
      (first == 0xF0 && byte(i + 1) < 0x90) || (first == 0xF4 && byte(i + 1) >= 0x90))
    return 0;
  return n;
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t n = utf8Length(text, i);
    const char c = text[i];
    if (n == 0 || (n == 1 && static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t'))
      out += "\xEF\xBF\xBD";
    else if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else
      out.append(text, i, n);
    i += std::max<std::size_t>(n, 1);
  }
  return out;
}

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  char text[64];
  if (value == std::round(value) && std::abs(value) < 1e9)
    std::snprintf(text, sizeof text, "%.0f", value == 0 ? 0.0 : value);
  else
    std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

std::vector<double> niceTicks(double low, double high, int wanted) {
  const double rough = std::max(high - low, 1e-12) / std::max(wanted, 1);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= rough * 0.999) {
      step = factor * power;
      break;
    }
  std::vector<double> ticks;
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i)
    ticks.push_back(i * step);
  return ticks;
}

Drawing::Drawing(const Frame& frame, Eigen::Vector2d low, Eigen::Vector2d high, bool equalScale)
    : low_(std::move(low)), high_(std::move(high)) {
  left_ = 58;
  right_ = frame.width - 14;
  top_ = 34;
  bottom_ = frame.height - 46;
  for (int i = 0; i < 2; ++i)
    if (!(high_[i] > low_[i])) high_[i] = low_[i] + 1;
  scale_ = Eigen::Vector2d(right_ - left_, bottom_ - top_).cwiseQuotient(high_ - low_);
  if (equalScale) {
    scale_.setConstant(scale_.minCoeff());
    const Eigen::Vector2d middle = (low_ + high_) / 2;
    const Eigen::Vector2d half = Eigen::Vector2d(right_ - left_, bottom_ - top_).cwiseQuotient(scale_) / 2;
    low_ = middle - half;
    high_ = middle + half;
  }
  axes(frame);
}

void Drawing::axes(const Frame& frame) {
  svg_ = "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\"" +
         attribute("viewBox", "0 0 " + px(frame.width) + " " + px(frame.height)) +
         attribute("width", px(frame.width)) + attribute("height", px(frame.height)) +
         attribute("aria-label", escaped(frame.title)) + ">";
  svg_ += "<text class=\"title\"" + attribute("x", px(left_)) + attribute("y", "18") + ">" +
          escaped(frame.title) + "</text>";
  for (const double tick : niceTicks(low_.x(), high_.x(), static_cast<int>((right_ - left_) / 80))) {
    svg_ += "<line class=\"grid\"" + attribute("x1", px(x(tick))) + attribute("x2", px(x(tick))) +
            attribute("y1", px(top_)) + attribute("y2", px(bottom_)) + "/>";
    svg_ += "<text text-anchor=\"middle\"" + attribute("x", px(x(tick))) + attribute("y", px(bottom_ + 16)) +
            ">" + number(tick) + "</text>";
  }
  for (const double tick : niceTicks(low_.y(), high_.y(), static_cast<int>((bottom_ - top_) / 45))) {
    svg_ += "<line class=\"grid\"" + attribute("x1", px(left_)) + attribute("x2", px(right_)) +
            attribute("y1", px(y(tick))) + attribute("y2", px(y(tick))) + "/>";
    svg_ += "<text text-anchor=\"end\"" + attribute("x", px(left_ - 6)) + attribute("y", px(y(tick) + 4)) +
            ">" + number(tick) + "</text>";
  }
  svg_ += "<line class=\"axis\"" + attribute("x1", px(left_)) + attribute("x2", px(right_)) +
          attribute("y1", px(bottom_)) + attribute("y2", px(bottom_)) + "/>";
  svg_ += "<line class=\"axis\"" + attribute("x1", px(left_)) + attribute("x2", px(left_)) +
          attribute("y1", px(top_)) + attribute("y2", px(bottom_)) + "/>";
  svg_ += "<text text-anchor=\"middle\"" + attribute("x", px((left_ + right_) / 2)) +
          attribute("y", px(bottom_ + 36)) + ">" + escaped(frame.xLabel) + "</text>";
  const std::string middle = px((top_ + bottom_) / 2);
  svg_ += "<text text-anchor=\"middle\"" + attribute("transform", "rotate(-90 14 " + middle + ")") +
          attribute("x", "14") + attribute("y", middle) + ">" + escaped(frame.yLabel) + "</text>\n";
}

void Drawing::line(Eigen::Vector2d from, Eigen::Vector2d to, Colour colour, double width, bool dashed) {
  svg_ += "<line" + attribute("x1", px(x(from.x()))) + attribute("y1", px(y(from.y()))) +
          attribute("x2", px(x(to.x()))) + attribute("y2", px(y(to.y()))) + attribute("stroke", hex(colour)) +
          attribute("stroke-width", px(width)) + (dashed ? " stroke-dasharray=\"5 4\"" : "") + "/>\n";
}

void Drawing::polyline(const std::vector<Eigen::Vector2d>& points, Colour colour, double width) {
  std::string list;
  for (const auto& p : points) list += px(x(p.x())) + "," + px(y(p.y())) + " ";
  svg_ += "<polyline fill=\"none\"" + attribute("stroke", hex(colour)) +
          attribute("stroke-width", px(width)) + attribute("points", list) + "/>\n";
}

void Drawing::dot(Eigen::Vector2d centre, double radius, Colour colour, const std::string& tooltip) {
  svg_ += "<circle" + attribute("cx", px(x(centre.x()))) + attribute("cy", px(y(centre.y()))) +
          attribute("r", px(radius)) + attribute("fill", hex(colour)) +
          " stroke=\"#222\" stroke-width=\"0.6\"><title>" + escaped(tooltip) + "</title></circle>\n";
}

void Drawing::bar(Eigen::Vector2d low, Eigen::Vector2d high, Colour colour, const std::string& tooltip) {
  svg_ += "<rect" + attribute("x", px(x(low.x()))) + attribute("y", px(y(high.y()))) +
          attribute("width", px(std::max(0.5, x(high.x()) - x(low.x())))) +
          attribute("height", px(y(low.y()) - y(high.y()))) + attribute("fill", hex(colour)) + "><title>" +
          escaped(tooltip) + "</title></rect>\n";
}

void Drawing::words(Eigen::Vector2d at, const std::string& text, int size) {
  svg_ += "<text" + attribute("x", px(x(at.x()) + 6)) + attribute("y", px(y(at.y()) - 5)) +
          attribute("font-size", std::to_string(size)) + ">" + escaped(text) + "</text>\n";
}

void Drawing::legend(const std::vector<LegendEntry>& entries) {
  // From the right, in one row beside the title.
  double at = right_;
  for (auto e = entries.rbegin(); e != entries.rend(); ++e) {
    at -= 7.0 * static_cast<double>(e->label.size());
    svg_ += "<text" + attribute("x", px(at)) + attribute("y", "18") + ">" + escaped(e->label) + "</text>";
    at -= 24;
    svg_ += "<line" + attribute("x1", px(at)) + attribute("x2", px(at + 18)) +
            " y1=\"14\" y2=\"14\" stroke-width=\"4\"" + attribute("stroke", hex(e->colour)) +
            (e->dashed ? " stroke-dasharray=\"5 4\"" : "") + "/>\n";
    at -= 12;
  }
}

std::string Drawing::finish() && { return std::move(svg_) + "</svg>\n"; }

std::string histogram(const Frame& frame, const std::vector<Series>& series, int bins) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Series& s : series)
    for (const double v : s.values) {
      low = std::min(low, v);
      high = std::max(high, v);
    }
  if (!(low <= high)) return "<p>" + escaped(frame.title) + ": no values.</p>\n";
  low = std::min(low, 0.0);
  const double step = high > low ? (high - low) / bins : 1;
  std::vector<std::vector<int>> counts(series.size(), std::vector<int>(static_cast<std::size_t>(bins), 0));
  int most = 1;
  for (std::size_t s = 0; s < series.size(); ++s)
    for (const double v : series[s].values) {
      const auto bin =
          std::min(static_cast<std::size_t>((v - low) / step), static_cast<std::size_t>(bins) - 1);
      most = std::max(most, ++counts[s][bin]);
    }
  Drawing drawing(frame, {low, 0}, {low + step * bins, most * 1.05});
  std::vector<LegendEntry> legend;
  for (std::size_t s = 0; s < series.size(); ++s) {
    legend.push_back({series[s].label, series[s].colour});
    const double share = 0.9 / static_cast<double>(series.size());
    for (std::size_t b = 0; b < counts[s].size(); ++b) {
      if (counts[s][b] == 0) continue;
      const double from = low + step * (static_cast<double>(b) + 0.05 + share * static_cast<double>(s));
      const double edge = low + step * static_cast<double>(b);
      drawing.bar({from, 0}, {from + share * step, counts[s][b]}, series[s].colour,
                  series[s].label + ", " + number(edge, 3) + " to " + number(edge + step, 3) + ": " +
                      std::to_string(counts[s][b]));
    }
  }
  if (series.size() > 1) drawing.legend(legend);
  return std::move(drawing).finish();
}

std::string lineChart(const Frame& frame, const std::vector<Series>& series) {
  constexpr std::size_t kMaxPoints = 600;
  std::size_t longest = 0;
  double high = 0;
  for (const Series& s : series) {
    longest = std::max(longest, s.values.size());
    for (const double v : s.values)
      if (std::isfinite(v)) high = std::max(high, v);
  }
  if (longest == 0) return "<p>" + escaped(frame.title) + ": no values.</p>\n";
  Drawing drawing(frame, {0, 0},
                  {static_cast<double>(std::max<std::size_t>(longest - 1, 1)), high > 0 ? high * 1.05 : 1});
  const std::size_t bin = longest / kMaxPoints + 1;
  std::vector<LegendEntry> legend;
  for (const Series& s : series) {
    std::vector<Eigen::Vector2d> points;
    for (std::size_t i = 0; i < s.values.size(); i += bin) {
      const auto end = s.values.begin() + static_cast<std::ptrdiff_t>(std::min(i + bin, s.values.size()));
      points.emplace_back(static_cast<double>(i),
                          *std::max_element(s.values.begin() + static_cast<std::ptrdiff_t>(i), end));
    }
    drawing.polyline(points, s.colour, 1.2);
    legend.push_back({s.label, s.colour});
  }
  if (series.size() > 1) drawing.legend(legend);
  return std::move(drawing).finish();
}

}  // namespace engram::exporters
