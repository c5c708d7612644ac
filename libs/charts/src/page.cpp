// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/charts/page.h"

#include "engram/base/error.h"
#include "engram/charts/markup.h"
#include "table_markup.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace engram::charts {
namespace {

constexpr const char* kStyle = R"(
body { font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; color: #1b1b1b; background: #fff; max-width: 1130px;
       margin: 24px auto; padding: 0 16px; }
h1 { font-size: 24px; margin: 0 0 4px; }
h2 { font-size: 18px; margin: 32px 0 8px; border-bottom: 1px solid #ccc; padding-bottom: 2px; break-after: avoid; }
p { max-width: 860px; margin: 8px 0; }
table { border-collapse: collapse; }
th, td { text-align: left; padding: 3px 18px 3px 0; border-bottom: 1px solid #e4e4e4; vertical-align: top; }
thead th { border-bottom: 1px solid #888; vertical-align: bottom; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; padding: 3px 0 3px 18px; white-space: nowrap; }
.n + :not(.n) { padding-left: 18px; }
.detail { font-size: 12px; color: #555; font-weight: 400; display: inline-block; min-width: 7em; }
.wide { overflow-x: auto; margin: 12px 0; }
.two { display: flex; flex-wrap: wrap; gap: 12px 26px; align-items: flex-start; }
figure { margin: 12px 0; break-inside: avoid; }
figcaption, .caption { font-size: 13.5px; color: #333; margin: 4px 0; max-width: 860px; }
.two figcaption { max-width: 550px; }
svg { max-width: 100%; height: auto; }
pre { background: #f6f6f6; padding: 10px; overflow-x: auto; font-size: 12.5px; line-height: 1.4; }
p.note { color: #444; margin: 4px 0; }
.share { display: inline-block; height: 10px; background: #0072b2; }
@page { margin: 14mm; }
@media print {
  body { font-size: 12px; margin: 0; padding: 0; max-width: none; }
  tr, .caption { break-inside: avoid; }
  thead { display: table-header-group; }
  .wide, pre { overflow: visible; }
  pre { white-space: pre-wrap; }
  details::details-content { content-visibility: visible; }
  .share { print-color-adjust: exact; }
}
)";

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  // "-0.0" is a zero.
  const bool zero = std::string_view(text).find_first_not_of("-0.") == std::string_view::npos;
  return zero && text[0] == '-' ? text + 1 : text;
}

void markBest(std::vector<Cell*> cells, Best best) {
  std::erase_if(cells, [](const Cell* c) { return !c->value || !std::isfinite(*c->value); });
  if (cells.empty()) return;
  const auto less = [](const Cell* a, const Cell* b) { return *a->value < *b->value; };
  const Cell* winner = best == Best::kLargest ? *std::max_element(cells.begin(), cells.end(), less)
                                              : *std::min_element(cells.begin(), cells.end(), less);
  for (Cell* c : cells) c->bold = c->text == winner->text;
}

std::string cellMarkup(const Cell& cell, const char* tag) {
  std::string out = "<";
  out.append(tag).append(cell.right ? " class=\"n\">" : ">");
  const std::string words = escaped(cell.text);
  out += cell.bold ? "<b>" + words + "</b>" : words;
  if (!cell.detail.empty()) out += " <span class=\"detail\">" + escaped(cell.detail) + "</span>";
  return out.append("</").append(tag).append(">");
}

}  // namespace

Cell::Cell(double number, int decimals, const std::string& unit)
    : text(fixed(number, decimals)), value(number), right(true) {
  if (!unit.empty() && std::isfinite(number)) text.append(" ").append(unit);
}

Cell::Cell(double number, double low, double high, int decimals) : Cell(number, decimals) {
  if (std::isfinite(number) && std::isfinite(low) && std::isfinite(high))
    detail = fixed(low, decimals) + " … " + fixed(high, decimals);
}

void markBestOfColumn(Table& table, std::size_t column, Best best, std::size_t first, std::size_t count) {
  std::vector<Cell*> cells;
  for (std::size_t r = first; r < table.rows.size() && r - first < count; ++r)
    if (column < table.rows[r].size()) cells.push_back(&table.rows[r][column]);
  markBest(std::move(cells), best);
}

void markBestOfRow(Table& table, std::size_t row, Best best) {
  std::vector<Cell*> cells;
  for (Cell& c : table.rows.at(row)) cells.push_back(&c);
  markBest(std::move(cells), best);
}

std::string markup(const Table& table) {
  std::string out = "<table>\n";
  if (!table.header.empty()) {
    out += "<thead><tr>";
    for (std::size_t c = 0; c < table.header.size(); ++c) {
      const bool right = std::any_of(table.rows.begin(), table.rows.end(),
                                     [&](const auto& row) { return c < row.size() && row[c].right; });
      out += (right ? "<th class=\"n\">" : "<th>") + escaped(table.header[c]) + "</th>";
    }
    out += "</tr></thead>\n";
  }
  out += "<tbody>\n";
  for (const auto& row : table.rows) {
    if (!table.header.empty() && row.size() != table.header.size())
      throw base::Error("table \"" + table.caption + "\": a row of " + std::to_string(row.size()) +
                        " cells below a header of " + std::to_string(table.header.size()));
    out += "<tr>";
    for (std::size_t c = 0; c < row.size(); ++c)
      out += cellMarkup(row[c], c == 0 && table.rowHeads ? "th" : "td");
    out += "</tr>\n";
  }
  return out + "</tbody></table>\n";
}

Page::Page(const std::string& title) : title_(title) {}

Page& Page::append(const std::string& markup) {
  body_ += markup;
  return *this;
}

Page& Page::heading(const std::string& words) { return endRow().append("<h2>" + escaped(words) + "</h2>\n"); }

Page& Page::paragraph(const std::string& words) { return append("<p>" + escaped(words) + "</p>\n"); }

Page& Page::note(const std::string& words) {
  return append("<p class=\"note\">" + escaped(words) + "</p>\n");
}

Page& Page::table(const Table& table) {
  append("<div class=\"wide\">");
  if (!table.caption.empty())
    append("<div class=\"caption\"><b>Table " + std::to_string(++tables_) + ".</b> " +
           escaped(table.caption) + "</div>\n");
  return append(markup(table) + "</div>\n");
}

Page& Page::figure(const std::string& chart, const std::string& caption) {
  append("<figure>" + chart);
  if (!caption.empty())
    append("<figcaption><b>Figure " + std::to_string(++figures_) + ".</b> " + escaped(caption) +
           "</figcaption>");
  return append("</figure>\n");
}

Page& Page::beginRow() {
  endRow();
  inRow_ = true;
  return append("<div class=\"two\">\n");
}

Page& Page::endRow() {
  if (inRow_) append("</div>\n");
  inRow_ = false;
  return *this;
}

Page& Page::preformatted(const std::string& text, const std::string& summary) {
  const std::string block = "<pre>" + escaped(text) + "</pre>";
  if (summary.empty()) return append(block + "\n");
  return append("<details><summary>" + escaped(summary) + "</summary>" + block + "</details>\n");
}

std::string Page::html() const {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"/>\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>" +
         escaped(title_) + "</title>\n<style>" + kStyle + "</style></head>\n<body>\n<h1>" + escaped(title_) +
         "</h1>\n" + body_ + (inRow_ ? "</div>\n" : "") + "</body>\n</html>\n";
}

}  // namespace engram::charts
