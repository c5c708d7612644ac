// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/charts/charts.h"
#include "engram/charts/colours.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace engram::charts {

/// Round numbers that divide [low, high] into about `wanted` parts, and their distance.
double tickStep(double low, double high, int wanted);
std::vector<double> niceTicks(double low, double high, int wanted);

enum class LegendKey { kLine, kDashed, kMarker, kSwatch };

struct LegendEntry {
  std::string label;
  Colour colour;
  LegendKey key = LegendKey::kLine;
  int style = 0;  ///< of a marker
};

/// What a drawing reserves its place for.
struct Layout {
  Eigen::Vector2d low, high;             ///< the corners of the plot, in data coordinates
  bool equalScale = false;               ///< one unit is as long in x as in y
  std::vector<double> xTicks = {};       ///< empty: round numbers
  std::vector<std::string> groups = {};  ///< names below x = 0, 1, … instead of numbers
  std::vector<LegendEntry> legend = {};  ///< in rows between the title and the plot
};

/// An SVG drawing with title, legend and axes. Data coordinates go in, pixels come out.
class Drawing {
 public:
  Drawing(const ChartFrame& frame, const Layout& layout);

  double x(double value) const { return left_ + (value - low_.x()) * scale_.x(); }
  double y(double value) const { return bottom_ - (value - low_.y()) * scale_.y(); }
  /// Width of a pixel in data coordinates.
  double pixel() const { return 1 / scale_.x(); }

  void line(Eigen::Vector2d from, Eigen::Vector2d to, Colour colour, double width, bool dashed = false);
  void polyline(const std::vector<Eigen::Vector2d>& points, Colour colour, double width);
  void band(const std::vector<Eigen::Vector2d>& low, const std::vector<Eigen::Vector2d>& high, Colour colour);
  void dot(Eigen::Vector2d centre, double radius, Colour colour, const std::string& tooltip);
  /// One of eight shapes in one of eight colours.
  void marker(Eigen::Vector2d at, int style, const std::string& tooltip);
  void errorBar(double at, double low, double high, Colour colour, bool rim = false);
  void bar(Eigen::Vector2d low, Eigen::Vector2d high, Colour colour, const std::string& tooltip);
  void words(Eigen::Vector2d at, const std::string& text, int size);

  std::string finish() &&;

 private:
  double drawTitle(const ChartFrame& frame);
  double drawLegend(const std::vector<LegendEntry>& entries, double from);
  double groupsHeight(const Layout& layout);
  void drawGrid(const Layout& layout);
  void drawGroups(const std::vector<std::string>& groups);
  void drawAxes(const ChartFrame& frame, bool zeroLine);
  void text(double atX, double atY, const std::string& words, const char* anchor,
            const std::string& more = "");
  void segment(double x1, double y1, double x2, double y2);

  Eigen::Vector2d low_, high_, scale_;
  double left_ = 0, right_ = 0, top_ = 0, bottom_ = 0;
  bool slanted_ = false;  ///< names of groups
  std::string svg_;
};

/// Colour of a style.
inline Colour styleColour(int style) { return categoryColour(static_cast<std::size_t>(style)); }

}  // namespace engram::charts
