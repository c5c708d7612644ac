// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/charts/page.h"
#include "engram/evaluation/bootstrap.h"

#include <nlohmann/json.hpp>

#include <concepts>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace engram::apps {

/// A mean with the standard deviation of what it is the mean of.
struct Spread {
  double mean = 0, sigma = 0;
  bool known = true;  ///< false: of no values; people then see a dash, files have zeros
};

/// What stands in a cell: nothing, yes or no, a number, an estimate, words; or a list or object, which only
/// JSON can hold.
using Value = std::variant<std::monostate, bool, std::int64_t, double, evaluation::Interval, Spread,
                           std::string, nlohmann::json>;

template <class T>
Value valueOf(const T& v) {
  if constexpr (std::integral<T> && !std::same_as<T, bool>)
    return static_cast<std::int64_t>(v);
  else if constexpr (std::convertible_to<T, std::string> && !std::same_as<T, nlohmann::json>)
    return std::string(v);
  else
    return v;
}
template <class T>
Value valueOf(const std::optional<T>& v) {
  return v ? valueOf(*v) : Value{};
}

/// How people see a number: times a factor over a divisor, with fixed decimals and, in text, its unit.
struct Shown {
  int decimals = 0;
  double factor = 1, divisor = 1;
  std::string unit = {};
};
inline Shown fixed(int decimals, const std::string& unit = "") { return {decimals, 1, 1, unit}; }
inline Shown percent(int decimals, const std::string& unit = "") { return {decimals, 100, 1, unit}; }
inline Shown kilo(int decimals) { return {decimals, 1, 1e3}; }
inline Shown mega(int decimals) { return {decimals, 1, 1e6}; }

/// Where a column appears, under which name and in which form. It is nowhere until it is put somewhere.
class ColumnForm {
 public:
  explicit ColumnForm(std::string name) : name_(std::move(name)) {}

  /// In the CSV file, numbers with so many decimals. An interval or a spread has further fields if they are
  /// named: its ends, or its deviation.
  ColumnForm& csv(int decimals = 0, const std::string& second = "", const std::string& third = "");
  /// In JSON with all digits; a dot in a key makes an object. The ends of an interval are one list of two, or
  /// have keys of their own.
  ColumnForm& json(const std::string& key = "", const std::string& second = "",
                   const std::string& third = "");
  /// On the page; the best number of the column can stand out.
  ColumnForm& page(const std::string& heading, const Shown& shown = {},
                   std::optional<charts::Best> best = {});
  /// In the table for a terminal, `width` characters wide; right-aligned when that is negative.
  ColumnForm& text(const std::string& heading, int width, const Shown& shown = {});

 private:
  friend class ResultTable;
  struct File {
    std::string name, second, third;
    int decimals = 0;
  };
  struct Seen {
    std::string heading;
    Shown shown;
    int width = 0;
    std::optional<charts::Best> best;
  };

  std::string name_;
  std::optional<File> csv_, json_;
  std::optional<Seen> page_, text_;
};

/// A table of results in all its forms.
class ResultTable {
 public:
  ResultTable(std::vector<ColumnForm> columns, std::vector<std::vector<Value>> rows)
      : columns_(std::move(columns)), rows_(std::move(rows)) {}

  /// With a line of names.
  std::string toCsv() const;
  /// A list of objects.
  nlohmann::json toJson() const;
  charts::Table toPage(const std::string& caption, bool rowHeads = false) const;
  /// @param head instead of the line of headings
  std::string toText(const std::string& head = "") const;

 private:
  std::vector<ColumnForm> columns_;
  std::vector<std::vector<Value>> rows_;
};

/// The columns of a table whose rows are made from `Row`: each is described once.
template <class Row>
class Columns {
 public:
  /// @param name in files, unless another one is given there. @param of a member of Row, or a function of it
  template <class Of>
  ColumnForm& add(const std::string& name, Of of) {
    values_.push_back([of](const Row& row) { return valueOf(std::invoke(of, row)); });
    return forms_.emplace_back(name);
  }

  template <class Rows>
  ResultTable table(const Rows& rows) const {
    std::vector<std::vector<Value>> cells;
    for (const Row& row : rows) {
      auto& values = cells.emplace_back();
      for (const auto& value : values_) values.push_back(value(row));
    }
    return {forms_, std::move(cells)};
  }

 private:
  std::vector<std::function<Value(const Row&)>> values_;
  std::vector<ColumnForm> forms_;
};

/// printf() into a string.
__attribute__((format(printf, 1, 2))) std::string line(const char* format, ...);

}  // namespace engram::apps
