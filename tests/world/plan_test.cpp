// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/plan.h"

#include "engram/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace engram::world {
namespace {

using testing::HasSubstr;

const std::string kGrid =
    "grid\n"
    "##########\n"
    "#........#\n"
    "#........=\n"
    "#........#\n"
    "#........#\n"
    "#+########\n"
    "#aaa#\n"
    "#aaa#\n"
    "#####\n"
    "end\n";
const std::string kRoute = "route 1,2.5 4,2.5 4,3.5 1,3.5\n";

std::string problemOf(const std::string& text) {
  try {
    parsePlan(text, "p.txt");
  } catch (const base::Error& e) {
    return e.what();
  }
  return "";
}

TEST(Plan, ReadsWhatItWrites) {
  const Plan plan = parsePlan("# a hall\nname hall\ncell 0.5\nheight 3\n" + kRoute + kGrid, "p.txt");
  EXPECT_EQ(plan.columns, 10);
  EXPECT_EQ(plan.rows, 9);
  EXPECT_EQ(plan.at(1, 1), 'a');
  EXPECT_EQ(plan.at(1, 3), '+');
  EXPECT_EQ(plan.at(9, 6), '=');
  EXPECT_EQ(plan.at(-1, 0), ' ');
  EXPECT_EQ(plan.at(9, 0), ' ');
  const Plan again = parsePlan(plan.toText(), "again");
  EXPECT_EQ(again.cells, plan.cells);
  EXPECT_EQ(again.route.size(), 4u);
  EXPECT_EQ(again.height, 3.0);
  EXPECT_FALSE(again.open);
  EXPECT_TRUE(parsePlan(parsePlan("roof none\n" + kRoute + kGrid, "p.txt").toText(), "again").open);
}

TEST(Plan, AnyEditorMayHaveWrittenIt) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("engram_plan_" + std::to_string(getpid()))).string();
  const std::string truth = parsePlan(kRoute + kGrid, "text").toText();
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string text = "\xEF\xBB\xBF" + kRoute + kGrid;
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += end.size())
      text.replace(at, 1, end);
    std::ofstream(path, std::ios::binary) << text;
    EXPECT_EQ(loadPlan(path).toText(), truth);
  }
  std::filesystem::remove(path);
}

TEST(Plan, SaysWhatIsWrong) {
  EXPECT_THAT(problemOf(""), HasSubstr("no grid"));
  EXPECT_THAT(problemOf("grid\n###\n"), HasSubstr("'end'"));
  EXPECT_THAT(problemOf("cell abc\n" + kRoute + kGrid), HasSubstr("p.txt:1: cell 'abc'"));
  EXPECT_THAT(problemOf("cell 0.5x\n" + kRoute + kGrid), HasSubstr("0.5x"));
  EXPECT_THAT(problemOf("celle 1\n" + kRoute + kGrid), HasSubstr("unknown key 'celle'"));
  EXPECT_THAT(problemOf("storeys 7\n" + kRoute + kGrid), HasSubstr("not 7 storeys of equal width"));
  EXPECT_THAT(problemOf("roof thatched\n" + kRoute + kGrid), HasSubstr("roof 'thatched'"));
  EXPECT_THAT(problemOf(kRoute + "grid\n###\n#?#\n###\nend\n"), HasSubstr("unknown character '?'"));
  EXPECT_THAT(problemOf(kRoute + "grid\n###\n#..\n###\nend\n"), HasSubstr("touches the outside"));
  EXPECT_THAT(problemOf(kRoute + "grid\n####\n#..+\n####\nend\n"), HasSubstr("door at column 3, row 1"));
  EXPECT_THAT(problemOf(kRoute + "grid\n#####\n#.=.#\n#####\nend\n"), HasSubstr("window at"));
  EXPECT_THAT(problemOf(kGrid), HasSubstr("at least 3 points"));
  EXPECT_THAT(problemOf("route 1,2.5 4,2.5 4,6\n" + kGrid), HasSubstr("meets a wall near"));
  EXPECT_THAT(problemOf("route 1,2.5 4,2.5 2,2.5 2,3.5\n" + kGrid), HasSubstr("reverses at point 1"));
  EXPECT_THAT(problemOf("route 1;2\n" + kGrid), HasSubstr("not x,y"));
  EXPECT_THROW(loadPlan("/nonexistent/plan.txt"), base::Error);
  EXPECT_THROW(presetPlan("castle", 1), base::Error);
}

// Every floor cell of a preset can be reached through doors, whatever the seed.
TEST(Plan, PresetsAreConnectedForAllSeeds) {
  for (const auto& name : presetNames())
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const Plan plan = presetPlan(name, seed);
      std::vector<bool> seen(plan.cells.size(), false);
      std::deque<std::pair<int, int>> open;
      std::size_t floor = 0, reached = 0;
      for (int y = 0; y < plan.rows; ++y)
        for (int x = 0; x < plan.columns; ++x)
          if (isFloor(plan.at(x, y)) && floor++ == 0)
            open.emplace_back(x, y), seen[y * plan.columns + x] = true;
      while (!open.empty()) {
        const auto [x, y] = open.front();
        open.pop_front();
        reached += isFloor(plan.at(x, y));
        for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
          const char c = plan.at(x + dx, y + dy);
          const auto i = (y + dy) * plan.columns + x + dx;
          if ((!isFloor(c) && c != '+') || seen[i]) continue;
          seen[i] = true;
          open.emplace_back(x + dx, y + dy);
        }
      }
      EXPECT_EQ(reached, floor) << name << " seed " << seed << "\n" << plan.toText();
    }
}

}  // namespace
}  // namespace engram::world
