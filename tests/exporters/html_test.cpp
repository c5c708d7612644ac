// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/exporters/html_report.h"
#include "exporter_fixture.h"
#include "well_formed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <regex>
#include <set>

namespace engram::exporters {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::vector<types::FrameReport> sampleRecords(std::size_t n) {
  base::Rng rng(3);
  std::vector<types::FrameReport> records(n);
  for (std::size_t i = 0; i < n; ++i) {
    types::FrameReport& r = records[i];
    r.index = i;
    r.label = "img";
    r.outcome = static_cast<types::Outcome>(i % 5);
    r.reason =
        r.outcome == types::Outcome::kRefused ? "only " + std::to_string(i) + " of 30 inliers <&>" : "";
    r.features = static_cast<int>(400 + rng.below(200));
    r.hypotheses = {{base::PlaceId(1), rng.uniform(), 0.5, 20}};
    r.times = {{"perceive", rng.uniform(4, 9)}, {"recognise", rng.uniform(1, 3)}};
    r.milliseconds = 13;
  }
  records[3].milliseconds = std::numeric_limits<double>::quiet_NaN();
  records[4].features = 0;
  return records;
}

using HtmlTest = ExporterTest;

TEST_F(HtmlTest, IsWellFormedAndLoadsNothing) {
  const auto records = sampleRecords(3000);
  map::MapHeader header;
  header.camera = "model = <unified> & more";
  header.parameters = "[a]\nb = 1 # \"quoted\"\n";
  const std::string html = toHtml({.title = "Map </title><script>alert(1)</script>",
                                   .header = &header,
                                   .map = &map_,
                                   .records = records,
                                   .figures = {{"ATE [m]", "0.31"}}});
  EXPECT_EQ(charts::whyNotWellFormed(html), "");
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(html, Not(HasSubstr("href")));
  EXPECT_THAT(html, Not(HasSubstr("src=")));
  EXPECT_THAT(html, Not(HasSubstr("@import")));
  EXPECT_THAT(html, Not(HasSubstr("url(")));
  // The one address is the name of the SVG language, which no browser loads.
  std::string rest = html;
  rest = std::regex_replace(rest, std::regex("xmlns=\"http://www.w3.org/2000/svg\""), "");
  EXPECT_THAT(rest, Not(HasSubstr("http")));
  EXPECT_THAT(rest, Not(HasSubstr("nan")));
  EXPECT_THAT(html, HasSubstr("&lt;unified&gt; &amp; more"));
  EXPECT_THAT(html, HasSubstr("0.31"));
}

TEST_F(HtmlTest, SaysWhatTheMapHolds) {
  const std::string html =
      toHtml({.title = "m", .header = nullptr, .map = &map_, .records = {}, .figures = {}});
  EXPECT_THAT(html, HasSubstr("<tr><th>Places</th><td class=\"n\">7</td></tr>"));
  EXPECT_THAT(html, HasSubstr("<tr><th>Edges: recognition</th><td class=\"n\">2</td></tr>"));
  EXPECT_THAT(html, HasSubstr("<tr><th>Sessions</th><td class=\"n\">2</td></tr>"));
  const std::regex circle("<circle");
  EXPECT_EQ(std::distance(std::sregex_iterator(html.begin(), html.end(), circle), {}), 7);
  EXPECT_EQ(charts::whyNotWellFormed(html), "");
}

TEST_F(HtmlTest, GroupsRefusalsByKind) {
  const auto records = sampleRecords(50);
  const std::string html =
      toHtml({.title = "m", .header = nullptr, .map = nullptr, .records = records, .figures = {}});
  EXPECT_THAT(html, HasSubstr("only # of # inliers &lt;&amp;&gt;</td><td class=\"n\">10</td>"));
}

TEST_F(HtmlTest, PartsMayBeMissing) {
  const map::TopologicalMap empty;
  EXPECT_EQ(charts::whyNotWellFormed(
                toHtml({.title = "", .header = nullptr, .map = &empty, .records = {}, .figures = {}})),
            "");
  const std::vector<types::FrameReport> one(1);
  EXPECT_EQ(charts::whyNotWellFormed(
                toHtml({.title = "", .header = nullptr, .map = nullptr, .records = one, .figures = {}})),
            "");
}

}  // namespace
}  // namespace engram::exporters
