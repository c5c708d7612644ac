// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/table.h"

#include <gmock/gmock.h>

#include <limits>

namespace engram::apps {
namespace {

using evaluation::Interval;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

struct Row {
  std::string name;
  int images = 0;
  bool closed = false;
  Interval share{0, 0, 0};
  Spread trials{};
  std::optional<double> error = std::nullopt;
};

ResultTable tableOf(const std::vector<Row>& rows) {
  Columns<Row> c;
  c.add("name", &Row::name).csv().json().page("who").text("who", 6);
  c.add("images", &Row::images).csv().json().page("images").text("images", -8);
  c.add("closed", &Row::closed).csv().json().page("closed");
  c.add("share", &Row::share)
      .csv(2, "share_low", "share_high")
      .json("", "share_95")
      .page("share [%]", percent(1), charts::Best::kLargest)
      .text("share [%]", 22, percent(1));
  c.add("trials_mean", &Row::trials)
      .csv(1, "trials_std")
      .json("trials.mean", "trials.std")
      .page("trials", fixed(1));
  c.add("error_m", &Row::error)
      .csv(3)
      .json("errors.ceres")
      .page("error [m]", fixed(2))
      .text("error", -8, fixed(2, "m"));
  c.add("", [](const Row& r) { return line("%d of 9", r.images); }).text("of all", 0);
  return c.table(rows);
}

const std::vector<Row> kRows{{"fsh", 3, true, {0.5, 0.25, 0.75, 2}, {1.5, 0.5}, 0.1234},
                             {"static", 12, false, {0.125, 0, 1, 2}, {0, 0, false}, std::nullopt}};

TEST(ResultTable, WritesCsvWithTheFurtherFieldsThatAreNamed) {
  EXPECT_EQ(tableOf(kRows).toCsv(),
            "name,images,closed,share,share_low,share_high,trials_mean,trials_std,error_m\n"
            "fsh,3,1,0.50,0.25,0.75,1.5,0.5,0.123\n"
            "static,12,0,0.12,0.00,1.00,0.0,0.0,\n");
}

TEST(ResultTable, WritesJsonWithAllDigits) {
  EXPECT_EQ(tableOf(kRows).toJson(), nlohmann::json::parse(R"([
    {"name": "fsh", "images": 3, "closed": true, "share": 0.5, "share_95": [0.25, 0.75],
     "trials": {"mean": 1.5, "std": 0.5}, "errors": {"ceres": 0.1234}},
    {"name": "static", "images": 12, "closed": false, "share": 0.125, "share_95": [0.0, 1.0],
     "trials": {"mean": 0.0, "std": 0.0}, "errors": {"ceres": null}}])"));
}

TEST(ResultTable, AlignsTextForATerminal) {
  EXPECT_EQ(tableOf(kRows).toText(),
            "who      images share [%]                 error of all\n"
            "fsh           3  50.0 [ 25.0,  75.0]      0.12m 3 of 9\n"
            "static       12  12.5 [  0.0, 100.0]         -m 12 of 9\n");
  EXPECT_EQ(tableOf({}).toText("a head of its own"), "a head of its own\n");
}

TEST(ResultTable, GivesPagesWordsAndMarksTheBest) {
  const charts::Table page = tableOf(kRows).toPage("caption", true);
  EXPECT_EQ(page.caption, "caption");
  EXPECT_TRUE(page.rowHeads);
  EXPECT_THAT(page.header, ElementsAre("who", "images", "closed", "share [%]", "trials", "error [m]"));
  std::vector<std::string> first, second;
  for (const auto& cell : page.rows.at(0)) first.push_back(cell.text + "|" + cell.detail);
  for (const auto& cell : page.rows.at(1)) second.push_back(cell.text + "|" + cell.detail);
  EXPECT_THAT(first, ElementsAre("fsh|", "3|", "yes|", "50.0|25.0 … 75.0", "1.5|(0.5)", "0.12|"));
  EXPECT_THAT(second, ElementsAre("static|", "12|", "no|", "12.5|0.0 … 100.0", "–|", "–|"));
  EXPECT_TRUE(page.rows[0][3].bold);
  EXPECT_FALSE(page.rows[1][3].bold);
}

TEST(ResultTable, AnUnknownIntervalIsNullAndHasNoEnds) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const ResultTable table = tableOf({{"one", 1, true, {0.5, nan, nan}}});
  EXPECT_EQ(table.toJson()[0].dump().find("\"share_95\":[null,null]") == std::string::npos, false);
  EXPECT_THAT(table.toPage("").rows[0][3].detail, IsEmpty());
}

TEST(ResultTable, MayBeEmpty) {
  EXPECT_EQ(tableOf({}).toJson(), nlohmann::json::array());
  EXPECT_THAT(tableOf({}).toPage("").rows, IsEmpty());
}

}  // namespace
}  // namespace engram::apps
