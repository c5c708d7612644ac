// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "colours.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace engram::exporters {

/// Text for HTML and SVG: markup characters are escaped, bytes that are not UTF-8 or not printable are
/// replaced.
std::string escaped(const std::string& text);

/// A number with at most `digits` significant digits and no exponent for common sizes.
std::string number(double value, int digits = 4);

/// Round numbers that divide [low, high] into about `wanted` parts.
std::vector<double> niceTicks(double low, double high, int wanted);

/// Sizes and words of a chart; pixels.
struct Frame {
  std::string title, xLabel, yLabel;
  double width = 520, height = 260;
};

struct Series {
  std::string label;
  Colour colour;
  std::vector<double> values;
};

struct LegendEntry {
  std::string label;
  Colour colour;
  bool dashed = false;
};

/// An SVG drawing with axes. Data coordinates go in, pixels come out.
class Drawing {
 public:
  /// @param equalScale one unit is as long in x as in y.
  Drawing(const Frame& frame, Eigen::Vector2d low, Eigen::Vector2d high, bool equalScale = false);

  double x(double value) const { return left_ + (value - low_.x()) * scale_.x(); }
  double y(double value) const { return bottom_ - (value - low_.y()) * scale_.y(); }

  void line(Eigen::Vector2d from, Eigen::Vector2d to, Colour colour, double width, bool dashed = false);
  void polyline(const std::vector<Eigen::Vector2d>& points, Colour colour, double width);
  void dot(Eigen::Vector2d centre, double radius, Colour colour, const std::string& tooltip);
  void bar(Eigen::Vector2d low, Eigen::Vector2d high, Colour colour, const std::string& tooltip);
  void legend(const std::vector<LegendEntry>& entries);
  void words(Eigen::Vector2d at, const std::string& text, int size);

  std::string finish() &&;

 private:
  void axes(const Frame& frame);

  Eigen::Vector2d low_, high_, scale_;
  double left_ = 0, right_ = 0, top_ = 0, bottom_ = 0;
  std::string svg_;
};

/// Bars side by side. No values: a sentence instead of a chart.
std::string histogram(const Frame& frame, const std::vector<Series>& series, int bins);

/// Values over their index. Long series are drawn as the largest value of each bin of neighbours.
std::string lineChart(const Frame& frame, const std::vector<Series>& series);

}  // namespace engram::exporters
