// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/charts/drawing.h"

#include "engram/charts/markup.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace engram::charts {
namespace {

constexpr double kFont = 12, kTitleFont = 13, kLine = 15;
constexpr double kSlant = 35 * M_PI / 180;

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

/// A shape of about 8 pixels around its first point.
std::string markerPath(double x, double y, int style, Colour colour) {
  struct Shape {
    const char* path;
    bool hollow;
  };
  static constexpr std::array<Shape, 8> kShapes{
      {{"m-3.7 0a3.7 3.7 0 1 0 7.4 0a3.7 3.7 0 1 0 -7.4 0z", false},
       {"m-3.3 -3.3h6.6v6.6h-6.6z", false},
       {"m0 -4.5l4.3 7.4h-8.6z", false},
       {"m0 -4.9l4.4 4.9l-4.4 4.9l-4.4 -4.9z", true},
       {"m-3.4 -3.4l6.8 6.8m0 -6.8l-6.8 6.8", false},
       {"m0 4.5l4.3 -7.4h-8.6z", false},
       {"m-3.3 -3.3h6.6v6.6h-6.6z", true},
       {"m-3.7 0a3.7 3.7 0 1 0 7.4 0a3.7 3.7 0 1 0 -7.4 0z", true}}};
  const Shape& shape = kShapes[static_cast<std::size_t>(style) % kShapes.size()];
  return "<path" +
         attribute("d", std::string("M").append(px(x)).append(" ").append(px(y)).append(shape.path)) +
         attribute("fill", shape.hollow ? "#ffffff" : hex(colour)) + attribute("stroke", hex(colour)) +
         " stroke-width=\"1.8\"";
}

/// Digits in groups of three from 10 000 on.
std::string tickLabel(double value) {
  std::string text = number(value);
  const bool whole = text.find_first_not_of("-0123456789") == std::string::npos;
  if (whole && std::abs(value) >= 10000)
    for (std::size_t at = text.size() - 3; at > (value < 0 ? 1u : 0u); at = at > 3 ? at - 3 : 0)
      text.insert(at, "\u202f");
  return text;
}

int yTickCount(double pixels) { return std::max(5, static_cast<int>(pixels / 36)); }

}  // namespace

double tickStep(double low, double high, int wanted) {
  const double rough = std::max(high - low, 1e-12) / std::max(wanted, 1);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= rough * 0.999) return factor * power;
  return 10 * power;
}

std::vector<double> niceTicks(double low, double high, int wanted) {
  const double step = tickStep(low, high, wanted);
  std::vector<double> ticks;
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i)
    ticks.push_back(i * step);
  return ticks;
}

Drawing::Drawing(const ChartFrame& frame, const Layout& layout) : low_(layout.low), high_(layout.high) {
  for (int i = 0; i < 2; ++i)
    if (!(high_[i] > low_[i])) high_[i] = low_[i] + 1;
  svg_ = "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\"" +
         attribute("viewBox", "0 0 " + px(frame.width) + " " + px(frame.height)) +
         attribute("width", px(frame.width)) + attribute("height", px(frame.height)) +
         attribute("aria-label", escaped(frame.title)) +
         " font-family=\"system-ui, DejaVu Sans, sans-serif\" font-size=\"12\" fill=\"#1b1b1b\">";
  left_ = 58;
  right_ = frame.width - 16;
  top_ = drawLegend(layout.legend, drawTitle(frame)) + 12;
  bottom_ = frame.height - 46;
  if (!layout.equalScale)
    for (const double tick : niceTicks(low_.y(), high_.y(), yTickCount(bottom_ - top_)))
      left_ = std::max(left_, 30 + textWidth(tickLabel(tick), kFont));
  bottom_ = frame.height - 30 - groupsHeight(layout);
  scale_ = Eigen::Vector2d(right_ - left_, bottom_ - top_).cwiseQuotient(high_ - low_);
  if (layout.equalScale) {
    scale_.setConstant(scale_.minCoeff());
    const Eigen::Vector2d middle = (low_ + high_) / 2;
    const Eigen::Vector2d half = Eigen::Vector2d(right_ - left_, bottom_ - top_).cwiseQuotient(scale_) / 2;
    low_ = middle - half;
    high_ = middle + half;
  }
  drawGrid(layout);
  drawGroups(layout.groups);
  drawAxes(frame, !layout.groups.empty() && low_.y() < 0 && high_.y() > 0);
}

void Drawing::text(double atX, double atY, const std::string& words, const char* anchor,
                   const std::string& more) {
  svg_ += "<text" + attribute("x", px(atX)) + attribute("y", px(atY)) + attribute("text-anchor", anchor) +
          more + ">" + escaped(words) + "</text>\n";
}

void Drawing::segment(double x1, double y1, double x2, double y2) {
  svg_ += "<line" + attribute("x1", px(x1)) + attribute("y1", px(y1)) + attribute("x2", px(x2)) +
          attribute("y2", px(y2)) + "/>";
}

double Drawing::drawTitle(const ChartFrame& frame) {
  double at = 4;
  // Bold letters are wider than textWidth() assumes.
  for (const auto& words : wrapped(frame.title, (frame.width - 30) / 1.1, kTitleFont))
    text(14, at += kLine, words, "start", " font-size=\"13\" font-weight=\"600\"");
  return at + 4;
}

double Drawing::drawLegend(const std::vector<LegendEntry>& entries, double from) {
  constexpr double kKey = 26, kGap = 16;
  double at = 14, row = from + kLine;
  for (const LegendEntry& e : entries) {
    const double width = kKey + textWidth(e.label, kFont);
    if (at > 14 && at + width > right_) {
      at = 14;
      row += kLine + 2;
    }
    const double middle = row - 4;
    if (e.key == LegendKey::kSwatch) {
      svg_ += "<rect" + attribute("x", px(at + 4)) + attribute("y", px(middle - 5)) +
              " width=\"12\" height=\"10\"" + attribute("fill", hex(e.colour)) + "/>";
    } else {
      svg_ += "<g" + attribute("stroke", hex(e.colour)) + " stroke-width=\"2\"" +
              (e.key == LegendKey::kDashed ? " stroke-dasharray=\"5 4\">" : ">");
      segment(at, middle, at + 20, middle);
      svg_ += "</g>";
      if (e.key == LegendKey::kMarker) svg_ += markerPath(at + 10, middle, e.style, e.colour) + "/>";
    }
    text(at + kKey, row, e.label, "start");
    at += width + kGap;
  }
  return entries.empty() ? from : row + 4;
}

/// Height of what stands between the plot and the label of the x axis.
double Drawing::groupsHeight(const Layout& layout) {
  const double slot = (right_ - left_) / static_cast<double>(std::max<std::size_t>(layout.groups.size(), 1));
  double widest = 0, full = 0;
  std::size_t lines = 1;
  for (const auto& name : layout.groups) {
    const auto parts = wrapped(name, slot - 6, kFont);
    lines = std::max(lines, parts.size());
    for (const auto& part : parts) widest = std::max(widest, textWidth(part, kFont));
    full = std::max(full, textWidth(name, kFont));
  }
  slanted_ = widest > slot - 2 || lines > 3;
  // A slanted name starts left of its group, but on the picture.
  if (slanted_) left_ = std::max(left_, std::cos(kSlant) * textWidth(layout.groups[0], kFont) - slot / 2 + 8);
  return slanted_ ? 12 + full * std::sin(kSlant) : 2 + kLine * static_cast<double>(lines);
}

void Drawing::drawGrid(const Layout& layout) {
  std::vector<double> xTicks = layout.xTicks;
  if (xTicks.empty() && layout.groups.empty())
    xTicks = niceTicks(low_.x(), high_.x(), static_cast<int>((right_ - left_) / 80));
  const auto yTicks = niceTicks(low_.y(), high_.y(), yTickCount(bottom_ - top_));
  svg_ += "<g stroke=\"#e4e4e4\">";
  for (const double tick : xTicks) segment(x(tick), top_, x(tick), bottom_);
  for (const double tick : yTicks) segment(left_, y(tick), right_, y(tick));
  svg_ += "</g>\n";
  for (const double tick : xTicks) text(x(tick), bottom_ + kLine, tickLabel(tick), "middle");
  for (const double tick : yTicks) text(left_ - 6, y(tick) + 4, tickLabel(tick), "end");
}

void Drawing::drawGroups(const std::vector<std::string>& groups) {
  const double slot = (right_ - left_) / static_cast<double>(std::max<std::size_t>(groups.size(), 1));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const double at = x(static_cast<double>(g));
    if (slanted_) {
      const std::string centre = px(at + 4) + " " + px(bottom_ + 12);
      text(at + 4, bottom_ + 12, groups[g], "end", attribute("transform", "rotate(-35 " + centre + ")"));
      continue;
    }
    double row = bottom_;
    for (const auto& line : wrapped(groups[g], slot - 6, kFont)) text(at, row += kLine, line, "middle");
  }
}

void Drawing::drawAxes(const ChartFrame& frame, bool zeroLine) {
  svg_ += "<g stroke=\"#444\">";
  segment(left_, bottom_, right_, bottom_);
  segment(left_, top_, left_, bottom_);
  if (zeroLine) segment(left_, y(0), right_, y(0));
  svg_ += "</g>\n";
  text((left_ + right_) / 2, frame.height - 8, frame.xLabel, "middle");
  const double middle = (top_ + bottom_) / 2;
  text(15, middle, frame.yLabel, "middle", attribute("transform", "rotate(-90 15 " + px(middle) + ")"));
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

void Drawing::band(const std::vector<Eigen::Vector2d>& low, const std::vector<Eigen::Vector2d>& high,
                   Colour colour) {
  std::string list;
  for (const auto& p : low) list += px(x(p.x())) + "," + px(y(p.y())) + " ";
  for (auto p = high.rbegin(); p != high.rend(); ++p) list += px(x(p->x())) + "," + px(y(p->y())) + " ";
  svg_ +=
      "<polygon fill-opacity=\"0.18\"" + attribute("fill", hex(colour)) + attribute("points", list) + "/>\n";
}

void Drawing::dot(Eigen::Vector2d centre, double radius, Colour colour, const std::string& tooltip) {
  svg_ += "<circle" + attribute("cx", px(x(centre.x()))) + attribute("cy", px(y(centre.y()))) +
          attribute("r", px(radius)) + attribute("fill", hex(colour)) +
          " stroke=\"#222\" stroke-width=\"0.6\"><title>" + escaped(tooltip) + "</title></circle>\n";
}

void Drawing::marker(Eigen::Vector2d at, int style, const std::string& tooltip) {
  svg_ += markerPath(x(at.x()), y(at.y()), style, styleColour(style)) + "><title>" + escaped(tooltip) +
          "</title></path>\n";
}

void Drawing::errorBar(double at, double low, double high, Colour colour, bool rim) {
  const auto draw = [&](const std::string& stroke, const char* width) {
    svg_ += "<g" + attribute("stroke", stroke) + attribute("stroke-width", width) + ">";
    segment(x(at), y(low), x(at), y(high));
    segment(x(at) - 3, y(low), x(at) + 3, y(low));
    segment(x(at) - 3, y(high), x(at) + 3, y(high));
    svg_ += "</g>\n";
  };
  // With a white rim it is seen on any bar.
  if (rim) draw("#ffffff", "3.4");
  draw(hex(colour), "1.2");
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

std::string Drawing::finish() && { return std::move(svg_) + "</svg>\n"; }

}  // namespace engram::charts
