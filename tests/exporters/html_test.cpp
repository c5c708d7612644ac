// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/exporters/html_report.h"
#include "exporter_fixture.h"
#include "well_formed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <cstdio>
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

/// The bytes of a data address, decoded by coreutils.
std::vector<std::uint8_t> decoded(const std::string& address) {
  const std::string head = "data:image/jpeg;base64,";
  EXPECT_TRUE(address.starts_with(head));
  const std::string command = "printf %s '" + address.substr(head.size()) + "' | base64 -d";
  FILE* pipe = ::popen(command.c_str(), "r");
  std::vector<std::uint8_t> bytes;
  for (int c; (c = std::fgetc(pipe)) != EOF;) bytes.push_back(static_cast<std::uint8_t>(c));
  EXPECT_EQ(::pclose(pipe), 0);
  return bytes;
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

TEST_F(HtmlTest, ShowsTheTwoImagesOfAClosureSideBySide) {
  const auto jpeg = [](int grey) {
    std::vector<std::uint8_t> bytes;
    cv::imencode(".jpg", cv::Mat(12, 16, CV_8U, cv::Scalar(grey)), bytes);
    return bytes;
  };
  const auto before = jpeg(40), now = jpeg(200);
  map_.addView(
      {.place = base::PlaceId(0), .stamp = 1, .frameIndex = 0, .label = "first.png", .jpeg = before});
  map_.addView({.place = base::PlaceId(0), .stamp = 9, .frameIndex = 8, .label = "again<.png", .jpeg = now});
  std::vector<types::FrameReport> records(1);
  records[0].index = 8;
  records[0].stamp = 9;
  records[0].label = "again<.png";
  records[0].outcome = types::Outcome::kRecognised;
  records[0].place = base::PlaceId(0);
  records[0].closure = true;
  records[0].hypotheses = {{base::PlaceId(0), 0.5, 0.9, 77}};
  const std::string html =
      toHtml({.title = "m", .header = nullptr, .map = &map_, .records = records, .figures = {}});
  EXPECT_EQ(charts::whyNotWellFormed(html), "");
  EXPECT_THAT(
      html,
      HasSubstr("Left: image 8 (again&lt;.png). Right: place 0, as seen in drive 1 (first.png). 77 matches"));
  // The oracle of base64 is another decoder: what the page holds is the picture, to the byte.
  std::vector<std::string> found;
  const std::regex source("src=\"([^\"]*)\"");
  for (std::sregex_iterator at(html.begin(), html.end(), source), end; at != end; ++at)
    found.push_back((*at)[1]);
  ASSERT_EQ(found.size(), 2u) << "nothing else is loaded";
  EXPECT_EQ(decoded(found[0]), now);
  EXPECT_EQ(decoded(found[1]), before);
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
