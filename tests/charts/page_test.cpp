// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/charts/page.h"

#include "engram/base/error.h"
#include "engram/charts/charts.h"
#include "well_formed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace engram::charts {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Table sampleTable() {
  return {.caption = "Success [%] <&>",
          .header = {"method", "clean", "error"},
          .rows = {{"fsh <b>", Cell(93.14, 91, 95.22, 1), Cell(0.5, 2, "m")},
                   {"bow", Cell(93.06, 90, 96, 1), Cell(0.7, 2, "m")},
                   {"static", Cell(80.0, 1), Cell(std::nan(""), 2, "m")}}};
}

TEST(Page, IsWellFormedAndLoadsNothing) {
  const std::string chart = curveChart({.title = "t", .xLabel = "x [m]", .yLabel = "y [s]"},
                                       {{"<script>alert(1)</script>", 0, {{1, {2, 1, 3}}, {2, {2, 1, 3}}}}});
  const std::string nasty = "</p><script>alert(\"1\")</script>&'\x01\xff";
  Page page(nasty);
  page.heading(nasty).paragraph(nasty).note(nasty);
  page.beginRow().figure(chart, nasty).figure(chart, "").endRow();
  page.beginRow().figure(chart, "second").heading("next");  // a heading ends the row
  page.table(sampleTable()).preformatted(nasty).preformatted("[a]\nb = 1\n", nasty);
  page.beginRow().note("the end of the page ends the row");
  const std::string html = page.html();
  EXPECT_EQ(whyNotWellFormed(html), "");
  for (const char* loads : {"<script", "href", "src=", "@import", "url("})
    EXPECT_THAT(html, Not(HasSubstr(loads)));
  const std::string rest = std::regex_replace(html, std::regex("xmlns=\"http://www.w3.org/2000/svg\""), "");
  EXPECT_THAT(rest, Not(HasSubstr("http")));
  EXPECT_THAT(html, HasSubstr("<title>&lt;/p&gt;&lt;script&gt;"));
  EXPECT_THAT(html, HasSubstr("[a]\nb = 1\n</pre>"));
  EXPECT_THAT(html, HasSubstr("<b>Figure 1.</b> &lt;/p&gt;"));
  EXPECT_THAT(html, HasSubstr("<b>Figure 2.</b> second"));
  EXPECT_THAT(html, HasSubstr("<b>Table 1.</b> Success [%] &lt;&amp;&gt;"));
  EXPECT_EQ(page.html(), html);
}

TEST(Page, TablesPutNumbersRight) {
  const std::string html = Page("t").table(sampleTable()).html();
  EXPECT_THAT(html, HasSubstr("<th>method</th><th class=\"n\">clean</th><th class=\"n\">error</th>"));
  EXPECT_THAT(html, HasSubstr("<td>fsh &lt;b&gt;</td><td class=\"n\">93.1 <span class=\"detail\">91.0 … 95.2"
                              "</span></td><td class=\"n\">0.50 m</td>"));
  EXPECT_THAT(html, HasSubstr("<td>static</td><td class=\"n\">80.0</td><td class=\"n\">–</td>"));
}

TEST(Page, RefusesARowThatDoesNotFitItsHeader) {
  Table t = sampleTable();
  t.rows[1].pop_back();
  EXPECT_THROW(Page("t").table(t), base::Error);
  t.header.clear();
  EXPECT_EQ(whyNotWellFormed(Page("t").table(t).html()), "");
}

TEST(Cell, WritesNumbersWithFixedDecimals) {
  EXPECT_EQ(Cell(1.005, 1).text, "1.0");
  EXPECT_EQ(Cell(-0.04, 1).text, "0.0");
  EXPECT_EQ(Cell(-0.06, 1).text, "-0.1");
  EXPECT_EQ(Cell(12345.6, 0).text, "12346");
  EXPECT_EQ(Cell(std::numeric_limits<double>::infinity(), 1).text, "–");
  EXPECT_EQ(Cell(3, std::nan(""), 4, 1).detail, "");
  EXPECT_TRUE(Cell(3, 0).right);
  EXPECT_FALSE(Cell("3").right);
}

TEST(MarkBest, MarksAllThatReadTheSame) {
  Table t = sampleTable();
  markBestOfColumn(t, 1, Best::kLargest);
  markBestOfColumn(t, 2, Best::kSmallest);
  // 93.14 and 93.06 both read 93.1.
  EXPECT_TRUE(t.rows[0][1].bold && t.rows[1][1].bold && !t.rows[2][1].bold);
  EXPECT_TRUE(t.rows[0][2].bold && !t.rows[1][2].bold && !t.rows[2][2].bold);
  EXPECT_THAT(Page("t").table(t).html(), HasSubstr("<td class=\"n\"><b>0.50 m</b></td>"));
  // Within a part of the rows, and again after the figures have changed.
  markBestOfColumn(t, 1, Best::kLargest, 1, 2);
  EXPECT_TRUE(t.rows[1][1].bold && !t.rows[2][1].bold);
  markBestOfColumn(t, 1, Best::kSmallest);
  EXPECT_TRUE(!t.rows[0][1].bold && !t.rows[1][1].bold && t.rows[2][1].bold);
  t.rows.push_back({"words", Cell(1.0, 1), Cell(3.0, 1)});
  markBestOfRow(t, 3, Best::kLargest);
  EXPECT_TRUE(!t.rows[3][0].bold && !t.rows[3][1].bold && t.rows[3][2].bold);
  markBestOfColumn(t, 0, Best::kLargest);  // words compete for nothing
  EXPECT_FALSE(t.rows[0][0].bold);
}

}  // namespace
}  // namespace engram::charts
