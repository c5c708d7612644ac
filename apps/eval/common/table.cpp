// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/table.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

namespace engram::apps {
namespace {

using evaluation::Interval;
using nlohmann::json;

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

std::string fixedText(double number, int decimals) { return line("%.*f", decimals, number); }

double scaled(double number, const Shown& shown) { return shown.factor * number / shown.divisor; }

/// The fields of one cell, with commas.
std::string csvCell(const Value& value, int decimals, bool second, bool third) {
  const auto further = [&](double number, bool wanted) {
    return wanted ? line(",%.*f", decimals, number) : std::string();
  };
  return std::visit(
      Overloaded{
          [](std::monostate) { return std::string(); }, [](bool yes) { return std::string(yes ? "1" : "0"); },
          [](std::int64_t n) { return std::to_string(n); }, [&](double d) { return fixedText(d, decimals); },
          [&](const Interval& i) {
            return fixedText(i.value, decimals) + further(i.low, second) + further(i.high, third);
          },
          [&](const Spread& s) { return fixedText(s.mean, decimals) + further(s.sigma, second); },
          [](const std::string& words) { return words; }, [](const json& j) { return j.dump(); }},
      value);
}

/// The member of an object at a key with dots.
json& member(json& object, const std::string& key) {
  const std::size_t dot = key.find('.');
  if (dot == std::string::npos) return object[key];
  return member(object[key.substr(0, dot)], key.substr(dot + 1));
}

json itself(const Value& value) {
  return std::visit(
      Overloaded{[](std::monostate) { return json(nullptr); },
                 [](const Interval& i) { return json(i.value); },
                 [](const Spread& s) { return json(s.mean); }, [](const auto& other) { return json(other); }},
      value);
}

/// Ends of an interval, deviation of a spread.
void addFurther(json& object, const Value& value, const std::string& second, const std::string& third) {
  if (second.empty()) return;
  if (const auto* spread = std::get_if<Spread>(&value)) {
    member(object, second) = spread->sigma;
    return;
  }
  const auto& interval = std::get<Interval>(value);
  if (third.empty()) {
    member(object, second) = {interval.low, interval.high};
    return;
  }
  member(object, second) = interval.low;
  member(object, third) = interval.high;
}

charts::Cell pageCell(const Value& value, const Shown& shown) {
  using charts::Cell;
  const auto number = [&](double n) { return Cell(scaled(n, shown), shown.decimals); };
  return std::visit(
      Overloaded{
          [](std::monostate) { return Cell("–"); }, [](bool yes) { return Cell(yes ? "yes" : "no"); },
          [&](std::int64_t n) { return number(static_cast<double>(n)); }, number,
          [&](const Interval& i) {
            return Cell(scaled(i.value, shown), scaled(i.low, shown), scaled(i.high, shown), shown.decimals);
          },
          [&](const Spread& s) {
            if (!s.known) return Cell("–");
            Cell cell = number(s.mean);
            cell.detail = line("(%s)", number(s.sigma).text.c_str());
            return cell;
          },
          [](const std::string& words) { return Cell(words); }, [](const json& j) { return Cell(j.dump()); }},
      value);
}

std::string textCell(const Value& value, const Shown& shown) {
  const auto number = [&](double n) { return fixedText(scaled(n, shown), shown.decimals) + shown.unit; };
  return std::visit(
      Overloaded{[&](std::monostate) { return std::string("-") + shown.unit; },
                 [](bool yes) { return std::string(yes ? "yes" : "no"); },
                 [&](std::int64_t n) { return number(static_cast<double>(n)); }, number,
                 [&](const Interval& i) {
                   return line("%5.*f [%5.*f, %5.*f]", shown.decimals, scaled(i.value, shown), shown.decimals,
                               scaled(i.low, shown), shown.decimals, scaled(i.high, shown));
                 },
                 [&](const Spread& s) {
                   return s.known ? line("%s (%s)", number(s.mean).c_str(), number(s.sigma).c_str())
                                  : std::string("-");
                 },
                 [](const std::string& words) { return words; }, [](const json& j) { return j.dump(); }},
      value);
}

}  // namespace

std::string line(const char* format, ...) {
  va_list first, second;
  va_start(first, format);
  va_copy(second, first);
  std::string text(static_cast<std::size_t>(std::max(0, std::vsnprintf(nullptr, 0, format, first))), '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, second);
  va_end(second);
  va_end(first);
  return text;
}

ColumnForm& ColumnForm::csv(int decimals, const std::string& second, const std::string& third) {
  csv_ = {name_, second, third, decimals};
  return *this;
}

ColumnForm& ColumnForm::json(const std::string& key, const std::string& second, const std::string& third) {
  json_ = {key.empty() ? name_ : key, second, third, 0};
  return *this;
}

ColumnForm& ColumnForm::page(const std::string& heading, const Shown& shown,
                             std::optional<charts::Best> best) {
  page_ = {heading, shown, 0, best};
  return *this;
}

ColumnForm& ColumnForm::text(const std::string& heading, int width, const Shown& shown) {
  text_ = {heading, shown, width, {}};
  return *this;
}

std::string ResultTable::toCsv() const {
  std::string csv;
  const auto next = [&csv](const std::string& field, bool first) {
    csv.append(first ? "" : ",").append(field);
  };
  bool first = true;
  for (const ColumnForm& c : columns_) {
    if (!c.csv_) continue;
    for (const auto& name : {c.csv_->name, c.csv_->second, c.csv_->third})
      if (!name.empty()) next(name, std::exchange(first, false));
  }
  csv += '\n';
  for (const auto& row : rows_) {
    first = true;
    for (std::size_t c = 0; c < row.size(); ++c)
      if (const auto& form = columns_[c].csv_)
        next(csvCell(row[c], form->decimals, !form->second.empty(), !form->third.empty()),
             std::exchange(first, false));
    csv += '\n';
  }
  return csv;
}

nlohmann::json ResultTable::toJson() const {
  json list = json::array();
  for (const auto& row : rows_) {
    json object = json::object();
    for (std::size_t c = 0; c < row.size(); ++c) {
      const auto& form = columns_[c].json_;
      if (!form) continue;
      member(object, form->name) = itself(row[c]);
      addFurther(object, row[c], form->second, form->third);
    }
    list.push_back(std::move(object));
  }
  return list;
}

charts::Table ResultTable::toPage(const std::string& caption, bool rowHeads) const {
  charts::Table table{caption, {}, {}, rowHeads};
  table.rows.resize(rows_.size());
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const auto& form = columns_[c].page_;
    if (!form) continue;
    table.header.push_back(form->heading);
    for (std::size_t r = 0; r < rows_.size(); ++r)
      table.rows[r].push_back(pageCell(rows_[r][c], form->shown));
    if (form->best) markBestOfColumn(table, table.header.size() - 1, *form->best);
  }
  return table;
}

std::string ResultTable::toText(const std::string& head) const {
  std::vector<std::string> lines(1 + rows_.size());
  std::vector<std::size_t> blanks(lines.size(), 0);  // up to the next column
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const auto& form = columns_[c].text_;
    if (!form) continue;
    const auto width = static_cast<std::size_t>(std::abs(form->width));
    for (std::size_t r = 0; r < lines.size(); ++r) {
      const std::string cell = r == 0 ? form->heading : textCell(rows_[r - 1][c], form->shown);
      const std::size_t padding = width > cell.size() ? width - cell.size() : 0;
      lines[r].append(blanks[r] + (form->width < 0 ? padding : 0), ' ').append(cell);
      blanks[r] = 1 + (form->width < 0 ? 0 : padding);
    }
  }
  if (!head.empty()) lines.front() = head;
  std::string text;
  for (const auto& l : lines) text += l + "\n";
  return text;
}

}  // namespace engram::apps
