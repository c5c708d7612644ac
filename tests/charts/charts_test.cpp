// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/charts/charts.h"

#include "engram/base/error.h"
#include "well_formed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

namespace engram::charts {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

const double kNaN = std::nan("");

/// All matches of a pattern, each as its groups.
std::vector<std::vector<std::string>> all(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::vector<std::vector<std::string>> out;
  for (std::sregex_iterator m(text.begin(), text.end(), regex); m != std::sregex_iterator(); ++m) {
    out.emplace_back();
    for (std::size_t g = 1; g < m->size(); ++g) out.back().push_back((*m)[g]);
  }
  return out;
}

/// Turns pixels back into data by two labels of an axis, as a reader would.
struct Axis {
  double pixel0 = 0, value0 = 0, scale = 1;
  double value(double pixel) const { return value0 + (pixel - pixel0) * scale; }
};

Axis axis(const std::string& svg, bool horizontal) {
  const std::string anchor = horizontal ? "middle" : "end";
  const auto ticks =
      all(svg, "<text x=\"([0-9.]+)\" y=\"([0-9.]+)\" text-anchor=\"" + anchor + "\">(-?[0-9.]+)</text>");
  if (ticks.size() < 2) throw std::logic_error("fewer than two labels");
  const std::size_t column = horizontal ? 0 : 1;
  const auto number = [&](const std::vector<std::string>& t, std::size_t i) { return std::stod(t[i]); };
  Axis out;
  out.pixel0 = number(ticks.front(), column) - (horizontal ? 0 : 4);
  out.value0 = number(ticks.front(), 2);
  out.scale =
      (number(ticks.back(), 2) - out.value0) / (number(ticks.back(), column) - number(ticks.front(), column));
  return out;
}

struct Mark {
  double x, y;
  std::string colour, tooltip;
};

std::vector<Mark> markers(const std::string& svg) {
  std::vector<Mark> out;
  const Axis xs = axis(svg, true), ys = axis(svg, false);
  for (const auto& m : all(svg,
                           "<path d=\"M([-0-9.]+) ([-0-9.]+)m[^\"]*\"[^>]* stroke=\"(#[0-9a-f]{6})\"[^>]*>"
                           "<title>([^<]*)</title>"))
    out.push_back({xs.value(std::stod(m[0])), ys.value(std::stod(m[1])), m[2], m[3]});
  return out;
}

ChartFrame frame() { return {.title = "Error <&>", .xLabel = "map update", .yLabel = "error [places]"}; }

std::vector<Curve> sampleCurves(int n) {
  std::vector<Curve> out;
  for (int s = 0; s < n; ++s) {
    Curve c{"method " + std::to_string(s), s, {}};
    for (int x = 1; x <= 8; ++x) {
      const double y = 3 - 0.25 * x + s;
      c.points.push_back({static_cast<double>(x), {y, y - 0.5, y + 0.25}});
    }
    out.push_back(c);
  }
  return out;
}

TEST(PathChart, IsAsLongInXAsInY) {
  const std::vector<Curve> paths{{"truth", 0, {{0, {0}}, {30, {0}}, {30, {10}}, {0, {10}}, {0, {0}}}}};
  const std::vector<Curve> marks{{"closure", 2, {{0, {0}}, {30, {10}}, {kNaN, {1}}}}};
  for (const double height : {200.0, 600.0}) {
    ChartFrame f = frame();
    f.height = height;
    const std::string svg = pathChart(f, paths, marks);
    EXPECT_EQ(whyNotWellFormed(svg, "<svg"), "");
    EXPECT_NEAR(axis(svg, true).scale, -axis(svg, false).scale, 1e-3);
    const auto found = markers(svg);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_NEAR(found[1].x, 30, 0.1);
    EXPECT_NEAR(found[1].y, 10, 0.1);
    EXPECT_EQ(found[1].tooltip, "closure: 30, 10");
    EXPECT_EQ(all(svg, "(<polyline)").size(), 1u);
    EXPECT_THAT(svg, HasSubstr(">truth</text>"));
    EXPECT_THAT(svg, HasSubstr(">closure</text>"));
  }
  EXPECT_THAT(pathChart(frame(), {{"nothing", 0, {}}}), HasSubstr("no values"));
}

TEST(CurveChart, PutsPointsWhereTheAxesSay) {
  const auto curves = sampleCurves(1);
  const std::string svg = curveChart(frame(), curves);
  const auto marks = markers(svg);
  ASSERT_EQ(marks.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(marks[i].x, curves[0].points[i].x, 0.005);
    EXPECT_NEAR(marks[i].y, curves[0].points[i].y.value, 0.005);
  }
  EXPECT_EQ(marks[1].tooltip, "method 0, 2: 2.5 (2 to 2.75)");
  // Error bars are upright lines from low to high.
  const Axis xs = axis(svg, true), ys = axis(svg, false);
  const auto bars = all(svg,
                        "stroke-width=\"1.2\"><line x1=\"([0-9.]+)\" y1=\"([0-9.]+)\" x2=\"([0-9.]+)\" "
                        "y2=\"([0-9.]+)\"");
  ASSERT_EQ(bars.size(), 8u);
  EXPECT_EQ(bars[2][0], bars[2][2]);
  EXPECT_NEAR(xs.value(std::stod(bars[2][0])), 3, 0.005);
  EXPECT_NEAR(ys.value(std::stod(bars[2][1])), 1.75, 0.005);
  EXPECT_NEAR(ys.value(std::stod(bars[2][3])), 2.5, 0.005);
}

TEST(CurveChart, SetsErrorBarsOfSeriesApart) {
  const auto marks = markers(curveChart(frame(), sampleCurves(6)));
  ASSERT_EQ(marks.size(), 48u);
  for (std::size_t s = 0; s + 1 < 6; ++s) {
    EXPECT_GT(marks[8 * (s + 1)].x - marks[8 * s].x, 0.02);
    // … but never nearer to another x than to their own.
    EXPECT_NEAR(marks[8 * s + 3].x, 4, 0.25);
  }
}

TEST(CurveChart, LabelsEveryMeasuredX) {
  const std::string svg = curveChart(frame(), {{"a", 0, {{0.1, {1}}, {0.2, {2}}, {0.4, {3}}, {0.9, {4}}}}});
  for (const char* x : {"0.1", "0.2", "0.4", "0.9"})
    EXPECT_THAT(svg, HasSubstr(std::string("text-anchor=\"middle\">") + x + "</text>"));
  Curve dense{"dense", 0, {}};
  for (int i = 0; i < 500; ++i) dense.points.push_back({i * 0.37, {1.0 * i}});
  EXPECT_LT(all(curveChart(frame(), {dense}), "text-anchor=\"middle\">([0-9.]+)</text>").size(), 20u);
}

TEST(CurveChart, InterruptsTheLineWhereNothingWasMeasured) {
  const std::vector<Curve> curves{
      {"a", 0, {{1, {1, 0, 2}}, {2, {2, 1, 3}}, {3, {kNaN}}, {4, {4, 3, 5}}, {5, {5, 4, 6}}}}};
  for (const Spread spread : {Spread::kBars, Spread::kBands}) {
    const std::string svg = curveChart(frame(), curves, spread);
    EXPECT_EQ(all(svg, "<polyline ()").size(), 2u);
    EXPECT_EQ(all(svg, "<polygon ()").size(), spread == Spread::kBands ? 2u : 0u);
    EXPECT_EQ(markers(svg).size(), 4u);
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
  }
}

TEST(CurveChart, KeepsTheAskedRangeAndHidesNothing) {
  ChartFrame f = frame();
  f.yRange = {0, 100};
  const auto heights = [](const std::string& svg) {
    std::vector<double> out;
    for (const auto& m : all(svg, "text-anchor=\"end\">([-0-9.]+)</text>")) out.push_back(std::stod(m[0]));
    return out;
  };
  EXPECT_THAT(heights(curveChart(f, {{"a", 0, {{1, {40}}, {2, {60}}}}})),
              ElementsAre(0, 20, 40, 60, 80, 100));
  const std::string beyond = curveChart(f, {{"a", 0, {{1, {40}}, {2, {150, 90, 170}}}}});
  const double top = axis(beyond, false).value(0);
  EXPECT_GT(top, 170);
  EXPECT_NEAR(markers(beyond)[1].y, 150, 0.5);
}

/// A reader finds title, axes with units and every series.
void expectComplete(const std::string& svg, const ChartFrame& f, const std::vector<std::string>& labels) {
  EXPECT_EQ(whyNotWellFormed(svg, "<svg"), "");
  EXPECT_THAT(svg, HasSubstr("font-weight=\"600\">Error &lt;&amp;&gt;</text>"));
  EXPECT_THAT(svg, HasSubstr(">" + f.xLabel + "</text>"));
  EXPECT_THAT(svg, HasSubstr(">" + f.yLabel + "</text>"));
  // The legend stands above all that is drawn at the height of the top of the y axis.
  double top = 1e9;
  for (const auto& m : all(svg, "<line x1=\"([0-9.]+)\" y1=\"([0-9.]+)\" x2=\"\\1\""))
    top = std::min(top, std::stod(m[1]));
  for (const auto& label : labels) {
    const auto found =
        all(svg, "<text x=\"([0-9.]+)\" y=\"([0-9.]+)\" text-anchor=\"start\">" + label + "</text>");
    ASSERT_EQ(found.size(), 1u) << label;
    EXPECT_LT(std::stod(found[0][1]), top) << label;
    EXPECT_LT(std::stod(found[0][0]) + 5.0 * static_cast<double>(label.size()), f.width) << label;
  }
}

TEST(Charts, AreWellFormedAndComplete) {
  const ChartFrame f = frame();
  std::vector<std::string> labels;
  for (int s = 0; s < 8; ++s) labels.push_back("method " + std::to_string(s));
  expectComplete(curveChart(f, sampleCurves(8)), f, labels);
  expectComplete(curveChart(f, sampleCurves(8), Spread::kBands), f, labels);
  expectComplete(curveChart(f, sampleCurves(1)), f, {"method 0"});
  std::vector<BarSeries> bars;
  std::vector<Distribution> values;
  for (int s = 0; s < 8; ++s) {
    bars.push_back({labels[static_cast<std::size_t>(s)], s, {{1.0 + s, 0.5, 2.0 + s}, {2}, {kNaN}}});
    values.push_back({labels[static_cast<std::size_t>(s)], s, {1, 2, 3.0 + s, kNaN}});
  }
  expectComplete(barChart(f, {"a", "b <&>", "c"}, bars), f, labels);
  expectComplete(cumulativeChart(f, values), f, labels);
  expectComplete(histogram(f, values, 5), f, labels);
  expectComplete(timeline(f, values), f, labels);
}

TEST(Charts, WithoutValuesAreASentence) {
  const std::string words = "<p>Error &lt;&amp;&gt;: no values.</p>\n";
  EXPECT_EQ(curveChart(frame(), {}), words);
  EXPECT_EQ(curveChart(frame(), {{"a", 0, {{1, {kNaN}}}}}), words);
  EXPECT_EQ(barChart(frame(), {}, {}), words);
  EXPECT_EQ(barChart(frame(), {"g"}, {{"a", 0, {{kNaN}}}}), words);
  EXPECT_EQ(cumulativeChart(frame(), {{"a", 0, {kNaN}}}), words);
  EXPECT_EQ(histogram(frame(), {{"a", 0, {}}}, 4), words);
  EXPECT_EQ(timeline(frame(), {}), words);
}

TEST(BarChart, BarsReachTheirValues) {
  const std::string svg =
      barChart(frame(), {"one", "two"}, {{"a", 0, {{4, 3, 5}, {-2}}}, {"b", 1, {{1}, {kNaN}}}});
  const Axis ys = axis(svg, false);
  std::map<std::string, std::array<double, 3>> bars;  // left edge, upper and lower end
  for (const auto& m : all(svg,
                           "<rect x=\"([0-9.]+)\" y=\"([0-9.]+)\" width=\"[0-9.]+\" height=\"([0-9.]+)\" "
                           "fill=\"#[0-9a-f]{6}\"><title>([^<]*)</title>"))
    bars[m[3]] = {std::stod(m[0]), ys.value(std::stod(m[1])), ys.value(std::stod(m[1]) + std::stod(m[2]))};
  ASSERT_EQ(bars.size(), 3u);
  const auto& a = bars.at("a, one: 4 (3 to 5)");
  EXPECT_NEAR(a[1], 4, 0.03);
  EXPECT_NEAR(a[2], 0, 0.03);
  EXPECT_NEAR(bars.at("a, two: -2")[1], 0, 0.03);
  EXPECT_NEAR(bars.at("a, two: -2")[2], -2, 0.03);
  EXPECT_LT(a[0], bars.at("b, one: 1")[0]);
  EXPECT_LT(bars.at("b, one: 1")[0], bars.at("a, two: -2")[0]);
  EXPECT_THAT(svg, HasSubstr(">–</text>"));
}

TEST(BarChart, WantsOneValueAGroup) {
  try {
    barChart(frame(), {"one", "two"}, {{"lonely", 0, {{4}}}});
    FAIL() << "no error";
  } catch (const base::Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("\"lonely\" has 1 values for 2 groups"));
  }
}

TEST(BarChart, KeepsLongNamesOnThePicture) {
  const std::string svg =
      barChart(frame(), {"gardens_point_night_right_hand_side", "x", "y", "z", "a_rather_long_name"},
               {{"a", 0, {{1}, {2}, {3}, {4}, {5}}}});
  const auto slanted =
      all(svg, "text-anchor=\"end\" transform=\"rotate\\(-35 ([0-9.]+) ([0-9.]+)\\)\">([^<]+)<");
  ASSERT_EQ(slanted.size(), 5u);
  // Letters of this size are at least 5.5 pixels wide on average.
  const double reach = 5.5 * static_cast<double>(slanted[0][2].size());
  EXPECT_GT(std::stod(slanted[0][0]), reach * std::cos(35 * M_PI / 180));
  EXPECT_LT(std::stod(slanted[0][1]) + reach * std::sin(35 * M_PI / 180), 340 - 20);
}

TEST(CumulativeChart, IsTheShareOfValuesUpToX) {
  std::vector<double> values;
  for (int i = 1; i <= 100; ++i) values.push_back(i);
  const std::string svg = cumulativeChart(frame(), {{"a", 0, values}}, Threshold{35, "35 points"});
  // 1 … 34 are under 35.
  EXPECT_THAT(svg, HasSubstr(">a: 34.0 % under</text>"));
  EXPECT_THAT(svg, HasSubstr(">35 points</text>"));
  for (const Mark& m : markers(svg)) EXPECT_NEAR(m.y, std::round(m.x), 0.3) << m.x;
  const Axis xs = axis(svg, true), ys = axis(svg, false);
  const auto line =
      all(svg, "<line x1=\"([0-9.]+)\" y1=\"([0-9.]+)\" x2=\"\\1\" y2=\"([0-9.]+)\" stroke=\"#464646\"");
  ASSERT_EQ(line.size(), 1u);
  EXPECT_NEAR(xs.value(std::stod(line[0][0])), 35, 0.1);
  // Every corner of the steps: at most one value, which is one per cent, beside y = x.
  const auto points = all(all(svg, "<polyline [^>]*points=\"([^\"]*)\"")[0][0], "([0-9.]+),([0-9.]+) ");
  ASSERT_GT(points.size(), 150u);
  double last = 0;
  for (const auto& p : points) {
    const double x = std::min(xs.value(std::stod(p[0])), 100.0), y = ys.value(std::stod(p[1]));
    EXPECT_NEAR(y, x, 1.3);
    EXPECT_GE(y, last - 0.1);
    last = y;
  }
  EXPECT_NEAR(last, 100, 0.1);
}

TEST(CumulativeChart, CountsWhatWasNeverFound) {
  const double inf = std::numeric_limits<double>::infinity();
  const std::string svg =
      cumulativeChart(frame(), {{"a", 0, {1, 2, 3, inf, kNaN}}, {"b", 1, {inf}}}, Threshold{2, "2"});
  EXPECT_THAT(svg, HasSubstr(">a: 25.0 % under</text>"));
  EXPECT_THAT(svg, HasSubstr(">b: 0.0 % under</text>"));
  double top = 0;
  for (const Mark& m : markers(svg)) top = std::max(top, m.y);
  EXPECT_NEAR(top, 75, 0.3);
}

TEST(Charts, GroupTheDigitsOfLargeNumbers) {
  const auto labels = [](double high) {
    std::vector<std::string> out;
    for (const auto& m : all(timeline(frame(), {{"a", 0, {high}}}), "text-anchor=\"end\">([^<]*)</text>"))
      out.push_back(m[0]);
    return out;
  };
  EXPECT_THAT(labels(1e6), ElementsAre("0", "200\u202f000", "400\u202f000", "600\u202f000", "800\u202f000",
                                       "1\u202f000\u202f000"));
  EXPECT_THAT(labels(5000), ElementsAre("0", "1000", "2000", "3000", "4000", "5000"));
}

TEST(Timeline, LeavesOutWhatIsNoNumber) {
  EXPECT_THAT(timeline(frame(), {{"a", 0, {1, kNaN, 3}}}), Not(HasSubstr("nan")));
}

using Vector3 = std::array<double, 3>;

Vector3 times(const std::array<Vector3, 3>& m, const Vector3& v) {
  Vector3 out{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) out[r] += m[r][c] * v[c];
  return out;
}

/// CIE L*a*b* (D65) of linear RGB.
Vector3 lab(const Vector3& rgb) {
  const Vector3 xyz = times({{{.4124, .3576, .1805}, {.2126, .7152, .0722}, {.0193, .1192, .9505}}}, rgb);
  const Vector3 white{.9505, 1, 1.089};
  Vector3 f{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double t = std::max(0.0, xyz[i] / white[i]);
    f[i] = t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116;
  }
  return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

// Colour vision deficiencies at full strength: Machado, Oliveira & Fernandes 2009.
TEST(Charts, ColoursDifferForColourBlindEyes) {
  const std::array<std::array<Vector3, 3>, 4> eyes{
      {{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
       {{{.152286, 1.052583, -.204868}, {.114503, .786281, .099216}, {-.003882, -.048116, 1.051998}}},
       {{{.367322, .860646, -.227968}, {.280085, .672501, .047413}, {-.011820, .042940, .968881}}},
       {{{1.255528, -.076749, -.178779}, {-.078411, .930809, .147602}, {.004733, .691367, .303900}}}}};
  std::vector<Vector3> colours;
  for (const Mark& m : markers(curveChart(frame(), sampleCurves(8)))) {
    if (m.tooltip.find(", 1:") == std::string::npos) continue;
    Vector3 c{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double v = std::stoi(m.colour.substr(1 + 2 * i, 2), nullptr, 16) / 255.0;
      c[i] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    }
    colours.push_back(c);
  }
  ASSERT_EQ(colours.size(), 8u);
  for (const auto& eye : eyes)
    for (std::size_t i = 0; i < 8; ++i) {
      const auto seen = [&](std::size_t k) {
        Vector3 c = times(eye, colours[k]);
        for (double& v : c) v = std::clamp(v, 0.0, 1.0);
        return lab(c);
      };
      const Vector3 a = seen(i);
      EXPECT_LT(a[0], 80) << "too light on white: " << i;
      for (std::size_t j = 0; j < i; ++j) {
        const Vector3 b = seen(j);
        EXPECT_GT(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]), i < 6 ? 36 : 29) << i << " and " << j;
      }
    }
}

}  // namespace
}  // namespace engram::charts
