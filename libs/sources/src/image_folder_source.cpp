// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/image_folder_source.h"

#include "engram/base/error.h"
#include "image_list.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <sstream>

namespace engram::sources {
namespace {

namespace fs = std::filesystem;

std::string trim(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r\"");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\"") - first + 1);
}

std::vector<std::string> splitLine(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(trim(cell));
  if (!line.empty() && line.back() == ',') cells.emplace_back();
  return cells;
}

double parseCell(const std::string& text, const std::string& origin, const std::string& column) {
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size())
    throw base::Error(origin + ": column '" + column + "': '" + text + "' is not a number");
  return value;
}

class CsvReader {
 public:
  CsvReader(const std::string& path, const std::string& header) : path_(path) {
    static const std::set<std::string> kKnown = {"image", "stamp", "right", "x", "y", "yaw"};
    const auto names = splitLine(header);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!kKnown.contains(names[i]))
        throw base::Error(path + ": unknown column '" + names[i] +
                          "'; known are image, stamp, right, x, y, yaw");
      if (!columns_.emplace(names[i], i).second)
        throw base::Error(path + ": the column '" + names[i] + "' stands twice");
    }
    if (!columns_.contains("image"))
      throw base::Error(path + ": the first line must name the columns, of which one is 'image'");
    const auto poseColumns = columns_.count("x") + columns_.count("y") + columns_.count("yaw");
    if (poseColumns != 0 && poseColumns != 3)
      throw base::Error(path + ": the columns x, y and yaw belong together");
  }

  ImageEntry parse(const std::string& line, int number, std::size_t index) const {
    const std::string origin = path_ + ":" + std::to_string(number);
    const auto cells = splitLine(line);
    if (cells.size() != columns_.size())
      throw base::Error(origin + ": " + std::to_string(cells.size()) + " columns instead of " +
                        std::to_string(columns_.size()));
    const auto cell = [&](const char* name) {
      const auto at = columns_.find(name);
      return at == columns_.end() ? std::string() : cells[at->second];
    };
    ImageEntry entry{cell("image"), cell("right"), cell("image"), static_cast<double>(index), {}};
    if (entry.image.empty()) throw base::Error(origin + ": the name of the image is missing");
    if (columns_.contains("stamp")) entry.stamp = parseCell(cell("stamp"), origin, "stamp");
    if (!std::isfinite(entry.stamp)) throw base::Error(origin + ": the stamp is not a finite number");
    if (!cell("x").empty())
      entry.pose = Pose2{parseCell(cell("x"), origin, "x"), parseCell(cell("y"), origin, "y"),
                         parseCell(cell("yaw"), origin, "yaw")};
    return entry;
  }

 private:
  std::string path_;
  std::map<std::string, std::size_t> columns_;
};

std::vector<ImageEntry> readCsv(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw base::Error(path + ": cannot be opened; does the file exist and may you read it?");
  std::optional<CsvReader> reader;
  std::vector<ImageEntry> entries;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (trim(line).empty() || line.front() == '#') continue;
    if (!reader)
      reader.emplace(path, line);
    else
      entries.push_back(reader->parse(line, number, entries.size()));
  }
  if (entries.empty()) throw base::Error(path + ": lists no images");
  return entries;
}

}  // namespace

bool naturalLess(const std::string& a, const std::string& b) {
  const auto isDigit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (isDigit(a[i]) && isDigit(b[j])) {
      std::size_t m = i, n = j;
      while (m < a.size() && a[m] == '0') ++m;
      while (n < b.size() && b[n] == '0') ++n;
      std::size_t p = m, q = n;
      while (p < a.size() && isDigit(a[p])) ++p;
      while (q < b.size() && isDigit(b[q])) ++q;
      if (p - m != q - n) return p - m < q - n;  // more digits, larger number
      const int order = a.compare(m, p - m, b, n, q - n);
      if (order != 0) return order < 0;
      i = p;
      j = q;
    } else if (a[i] != b[j]) {
      return a[i] < b[j];
    } else {
      ++i;
      ++j;
    }
  }
  const std::size_t leftA = a.size() - i, leftB = b.size() - j;
  return leftA != leftB ? leftA < leftB : a < b;  // img1 before img01: a total order
}

std::vector<std::string> listImages(const std::string& folder) {
  static const std::set<std::string> kKnown = {".jpg", ".jpeg", ".png",  ".bmp", ".pgm",
                                               ".ppm", ".tif",  ".tiff", ".webp"};
  std::error_code status;
  if (!fs::is_directory(folder, status)) throw base::Error(folder + ": no such folder");
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder, status)) {
    std::string extension = entry.path().extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (kKnown.contains(extension)) names.push_back(entry.path().filename().string());
  }
  if (status) throw base::Error(folder + ": cannot be read: " + status.message());
  if (names.empty()) throw base::Error(folder + ": holds no images (jpg, png, bmp, pgm, ppm, tif, webp)");
  std::sort(names.begin(), names.end(), naturalLess);
  return names;
}

std::unique_ptr<FrameSource> openImageFolder(const std::string& folder, const std::string& csv) {
  std::error_code status;
  if (!fs::is_directory(folder, status)) throw base::Error(folder + ": no such folder");
  std::vector<ImageEntry> entries;
  if (!csv.empty()) entries = readCsv(csv);
  if (csv.empty())
    for (const auto& name : listImages(folder))
      entries.push_back({name, {}, name, static_cast<double>(entries.size()), {}});
  const auto inFolder = [&folder](const std::string& name) {
    return name.empty() ? name : (fs::path(folder) / name).string();
  };
  for (auto& entry : entries) {
    entry.image = inFolder(entry.image);
    entry.right = inFolder(entry.right);
  }
  return makeListSource(folder, std::move(entries));
}

}  // namespace engram::sources
