// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/plan.h"

#include "engram/base/error.h"
#include "engram/base/text.h"
#include "engram/base/text_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

namespace engram::world {
namespace {

constexpr double kRobotRadius = 0.3;   // [m] free space that the route needs
constexpr double kSharpestTurn = 2.7;  // [rad]; beyond it the smoothed path would have a cusp
constexpr int kLargestSide = 2000;     // cells

[[noreturn]] void fail(const std::string& name, int line, const std::string& what) {
  throw base::Error(name + (line > 0 ? ":" + std::to_string(line) : "") + ": " + what);
}

std::string cellName(int x, int y) {
  return "column " + std::to_string(x) + ", row " + std::to_string(y) + " (from the bottom)";
}

double readNumber(const std::string& name, int line, const std::string& key, const std::string& text,
                  double low, double high) {
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != text.size() || !(value >= low && value <= high)) {
    std::ostringstream bounds;
    bounds << key << " " << base::quoted(text) << " is not a number in [" << low << ", " << high << "]";
    fail(name, line, bounds.str());
  }
  return value;
}

Eigen::Vector2d readPoint(const std::string& name, int line, const std::string& text) {
  const auto comma = text.find(',');
  if (comma == std::string::npos)
    fail(name, line, "route point " + base::quoted(text) + " is not x,y in metres");
  return {readNumber(name, line, "route x", text.substr(0, comma), 0, 1e4),
          readNumber(name, line, "route y", text.substr(comma + 1), 0, 1e4)};
}

void readGrid(const std::string& name, std::istream& in, int& line, Plan& plan) {
  std::vector<std::string> lines;
  std::string text;
  bool ended = false;
  while (std::getline(in, text)) {
    ++line;
    if (text == "end") {
      ended = true;
      break;
    }
    for (const char c : text)
      if (!isFloor(c) && std::string(" #+=").find(c) == std::string::npos)
        fail(name, line,
             std::string("unknown character '") + c + "' in the grid; use # . a-z + = or a blank");
    lines.push_back(text);
  }
  if (!ended) fail(name, line, "the grid has no line 'end'");
  for (const auto& l : lines) plan.columns = std::max(plan.columns, static_cast<int>(l.size()));
  plan.rows = static_cast<int>(lines.size());
  if (plan.columns == 0 || plan.rows == 0) fail(name, line, "the grid is empty");
  if (plan.columns > kLargestSide || plan.rows > kLargestSide)
    fail(name, line, "the grid is larger than " + std::to_string(kLargestSide) + " cells a side");
  plan.cells.assign(static_cast<std::size_t>(plan.columns) * plan.rows, ' ');
  for (int y = 0; y < plan.rows; ++y)
    std::copy(lines[y].begin(), lines[y].end(), plan.cells.begin() + (plan.rows - 1 - y) * plan.columns);
}

// True when the opening at (x, y) joins what `test` wants on both sides, in one of the two directions.
template <class Test>
bool joins(const Plan& plan, int x, int y, Test test) {
  return test(plan.at(x - 1, y), plan.at(x + 1, y)) || test(plan.at(x, y - 1), plan.at(x, y + 1));
}

void checkCells(const Plan& plan, const std::string& name) {
  for (int y = 0; y < plan.rows; ++y)
    for (int x = 0; x < plan.columns; ++x) {
      const char c = plan.at(x, y);
      if (isFloor(c))
        for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
          if (plan.at(x + dx, y + dy) == ' ')
            fail(name, 0, "the floor at " + cellName(x, y) + " touches the outside; close it with #, + or =");
      if (c == '+' && !joins(plan, x, y, [](char a, char b) { return isFloor(a) && isFloor(b); }))
        fail(name, 0, "the door at " + cellName(x, y) + " does not lead from floor to floor");
      const auto outward = [](char a, char b) {
        return (isFloor(a) && b == ' ') || (isFloor(b) && a == ' ');
      };
      if (c == '=' && !joins(plan, x, y, outward))
        fail(name, 0, "the window at " + cellName(x, y) + " is not between floor and outside");
    }
}

bool isFree(const Plan& plan, const Eigen::Vector2d& p) {
  const char c = plan.at(static_cast<int>(std::floor(p.x() / plan.cell)),
                         static_cast<int>(std::floor(p.y() / plan.cell)));
  return isFloor(c) || c == '+';
}

void checkRoute(const Plan& plan, const std::string& name) {
  const auto n = plan.route.size();
  if (n < 3) fail(name, 0, "the route needs at least 3 points");
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d a = plan.route[i], b = plan.route[(i + 1) % n], c = plan.route[(i + 2) % n];
    const double length = (b - a).norm();
    if (length < 0.2)
      fail(name, 0, "route points " + std::to_string(i) + " and its next are nearer than 0.2 m");
    for (double s = 0; s <= length; s += 0.05) {
      const Eigen::Vector2d p = a + (b - a) * (s / length);
      const Eigen::Vector2d side(-(b - a).y() / length * kRobotRadius, (b - a).x() / length * kRobotRadius);
      if (!isFree(plan, p) || !isFree(plan, p + side) || !isFree(plan, p - side)) {
        char where[48];
        std::snprintf(where, sizeof where, "%.2f,%.2f", p.x(), p.y());
        fail(name, 0,
             std::string("the route meets a wall near ") + where + " (it needs 0.3 m on both sides)");
      }
    }
    const Eigen::Vector2d u = b - a, v = c - b;
    const double turn = std::abs(std::atan2(u.x() * v.y() - u.y() * v.x(), u.dot(v)));
    if (turn > kSharpestTurn)
      fail(name, 0,
           "the route reverses at point " + std::to_string((i + 1) % n) + "; turn in a loop instead");
  }
}

void check(const Plan& plan, const std::string& name) {
  if (plan.columns % plan.storeys != 0)
    fail(name, 0,
         std::to_string(plan.columns) + " columns are not " + std::to_string(plan.storeys) +
             " storeys of equal width; fill up the last one with #");
  checkCells(plan, name);
  checkRoute(plan, name);
}

}  // namespace

Plan parsePlan(const std::string& text, const std::string& name) {
  Plan plan;
  std::istringstream in(text);
  std::string lineText;
  int line = 0;
  while (std::getline(in, lineText)) {
    ++line;
    std::istringstream words(lineText);
    std::string key, value;
    if (!(words >> key) || key[0] == '#') continue;
    if (key == "grid") {
      if (plan.rows > 0) fail(name, line, "a second grid");
      readGrid(name, in, line, plan);
    } else if (key == "route") {
      while (words >> value) plan.route.push_back(readPoint(name, line, value));
    } else if (key == "name" || key == "cell" || key == "height" || key == "roof" || key == "storeys") {
      if (!(words >> value)) fail(name, line, key + " has no value");
      if (key == "name") plan.name = value;
      if (key == "cell") plan.cell = readNumber(name, line, key, value, 0.2, 2.0);
      if (key == "height") plan.height = readNumber(name, line, key, value, 2.3, 15.0);
      if (key == "storeys") plan.storeys = static_cast<int>(readNumber(name, line, key, value, 1, 50));
      if (key == "roof" && value != "flat" && value != "none")
        fail(name, line, "roof " + base::quoted(value) + " is neither flat nor none");
      if (key == "roof") plan.open = value == "none";
    } else {
      fail(name, line,
           "unknown key " + base::quoted(key) + "; use name, cell, height, roof, storeys, route or grid");
    }
  }
  if (plan.rows == 0) fail(name, 0, "no grid; see the description of the plan format");
  check(plan, name);
  return plan;
}

Plan loadPlan(const std::string& path) { return parsePlan(base::readTextFile(path), path); }

std::string Plan::toText() const {
  std::ostringstream out;
  out << "name " << name << "\ncell " << cell << "\nheight " << height << "\n";
  if (open) out << "roof none\n";
  if (storeys > 1) out << "storeys " << storeys << "\n";
  for (const auto& p : route) out << "route " << p.x() << "," << p.y() << "\n";
  out << "grid\n";
  for (int y = rows - 1; y >= 0; --y) {
    std::string l(cells.begin() + y * columns, cells.begin() + (y + 1) * columns);
    l.erase(l.find_last_not_of(' ') + 1);
    out << l << "\n";
  }
  out << "end\n";
  return out.str();
}

}  // namespace engram::world
