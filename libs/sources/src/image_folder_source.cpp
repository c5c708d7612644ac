// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/image_folder_source.h"

#include "engram/base/error.h"
#include "engram/base/text.h"
#include "engram/base/text_file.h"
#include "image_list.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
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
    throw base::Error(origin + ": column '" + column + "': " + base::quoted(text) + " is not a number");
  return value;
}

class CsvReader {
 public:
  CsvReader(const std::string& path, const std::string& header) : path_(path) {
    static const std::set<std::string> kKnown = {"image", "stamp", "right", "x", "y", "yaw"};
    const auto names = splitLine(header);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!kKnown.contains(names[i]))
        throw base::Error(path + ": unknown column " + base::quoted(names[i]) +
                          "; known are image, stamp, right, x, y, yaw");
      if (!columns_.emplace(names[i], i).second)
        throw base::Error(path + ": the column " + base::quoted(names[i]) + " stands twice");
    }
    if (!columns_.contains("image"))
      throw base::Error(path + ": the first line must name the columns, of which one is 'image'");
    const auto poseColumns = columns_.count("x") + columns_.count("y") + columns_.count("yaw");
    if (poseColumns != 0 && poseColumns != 3)
      throw base::Error(path + ": the columns x, y and yaw belong together");
  }

  bool hasStamps() const { return columns_.contains("stamp"); }

  /// @param stamp receives the text of the stamp, which is a number
  ImageEntry parse(const std::string& line, int number, std::size_t index, std::string& stamp) const {
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
    if (hasStamps() && !std::isfinite(parseCell(cell("stamp"), origin, "stamp")))
      throw base::Error(origin + ": the stamp is not a finite number");
    stamp = cell("stamp");
    if (!cell("x").empty())
      entry.pose = Pose2{parseCell(cell("x"), origin, "x"), parseCell(cell("y"), origin, "y"),
                         parseCell(cell("yaw"), origin, "yaw")};
    return entry;
  }

 private:
  std::string path_;
  std::map<std::string, std::size_t> columns_;
};

struct Csv {
  std::vector<ImageEntry> entries;
  StampReading reading;
};

Csv readCsv(const std::string& path, StampUnit unit) {
  std::istringstream in(base::readTextFile(path));
  std::optional<CsvReader> reader;
  Csv csv;
  std::vector<std::string> stamps;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (trim(line).empty() || line.front() == '#') continue;
    if (!reader)
      reader.emplace(path, line);
    else
      csv.entries.push_back(reader->parse(line, number, csv.entries.size(), stamps.emplace_back()));
  }
  if (csv.entries.empty()) throw base::Error(path + ": lists no images");
  if (reader->hasStamps()) csv.reading = setStamps(csv.entries, stamps, unit);
  return csv;
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

bool isImageName(const std::string& name) {
  static const std::set<std::string> kKnown = {".jpg", ".jpeg", ".png",  ".bmp", ".pgm",
                                               ".ppm", ".tif",  ".tiff", ".webp"};
  std::string extension = fs::path(name).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return kKnown.contains(extension);
}

std::vector<std::string> listImages(const std::string& folder) {
  std::error_code status;
  if (!fs::is_directory(folder, status)) throw base::Error(folder + ": no such folder");
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder, status)) {
    std::string name = entry.path().filename().string();
    if (isImageName(name)) names.push_back(std::move(name));
  }
  if (status) throw base::Error(folder + ": cannot be read: " + status.message());
  if (names.empty()) throw base::Error(folder + ": holds no images (jpg, png, bmp, pgm, ppm, tif, webp)");
  std::sort(names.begin(), names.end(), naturalLess);
  return names;
}

std::unique_ptr<ImageListSource> openImageFolder(const std::string& folder, const std::string& csv,
                                                 StampUnit unit) {
  std::error_code status;
  if (!fs::is_directory(folder, status)) throw base::Error(folder + ": no such folder");
  Csv list;
  if (!csv.empty()) list = readCsv(csv, unit);
  if (csv.empty())
    for (const auto& name : listImages(folder))
      list.entries.push_back({name, {}, name, static_cast<double>(list.entries.size()), {}});
  const auto inFolder = [&folder](const std::string& name) {
    return name.empty() ? name : (fs::path(folder) / name).string();
  };
  for (auto& entry : list.entries) {
    entry.image = inFolder(entry.image);
    entry.right = inFolder(entry.right);
  }
  return makeListSource(folder, std::move(list.entries), {{}, list.reading});
}

}  // namespace engram::sources
