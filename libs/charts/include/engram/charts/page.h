// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace engram::charts {

/// One cell of a table.
struct Cell {
  std::string text;
  std::optional<double> value = std::nullopt;  ///< of a number, which may be the best
  std::string detail = {};                     ///< in smaller letters behind the text: an interval
  bool bold = false;
  bool right = false;  ///< stands right, as numbers do

  Cell(std::string words) : text(std::move(words)) {}  // NOLINT: a text is a cell
  Cell(const char* words) : text(words) {}             // NOLINT
  /// A number with fixed decimals and its unit; "–" when it is not finite.
  Cell(double number, int decimals, const std::string& unit = "");
  /// "93.1" with "91.0 … 95.2" behind it; without the interval when an end is not finite.
  Cell(double number, double low, double high, int decimals);
};

/// A table. Columns of numbers stand right, with their header.
struct Table {
  std::string caption = {};
  std::vector<std::string> header = {};  ///< may be empty
  std::vector<std::vector<Cell>> rows = {};
  bool rowHeads = false;  ///< the first cell of each row is a heading
};

enum class Best { kLargest, kSmallest };

/// Makes the best number of `column` in rows first .. first + count - 1 bold, and all that read the same.
void markBestOfColumn(Table& table, std::size_t column, Best best, std::size_t first = 0,
                      std::size_t count = static_cast<std::size_t>(-1));
/// The same across a row.
void markBestOfRow(Table& table, std::size_t row, Best best);

/// An HTML page that loads nothing: style and drawings are inside, there is no script. All words are escaped.
/// Figures and tables with captions are numbered in their order.
class Page {
 public:
  explicit Page(const std::string& title);

  Page& heading(const std::string& words);
  Page& paragraph(const std::string& words);
  /// A paragraph in softer colour.
  Page& note(const std::string& words);
  Page& table(const Table& table);
  /// @param chart a drawing of charts.h.
  Page& figure(const std::string& chart, const std::string& caption);
  /// What follows stands side by side where the page is wide enough, until endRow() or the next heading.
  Page& beginRow();
  Page& endRow();
  /// Text as it is, such as a configuration. With a summary it is folded on the screen.
  Page& preformatted(const std::string& text, const std::string& summary = "");
  /// Well-formed markup that is escaped already.
  Page& append(const std::string& markup);

  /// The whole page; write it with base::writeText().
  std::string html() const;

 private:
  std::string title_, body_;
  int figures_ = 0, tables_ = 0;
  bool inRow_ = false;
};

}  // namespace engram::charts
