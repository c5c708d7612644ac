// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/image_pairs.h"

#include "engram/base/error.h"
#include "engram/base/text.h"
#include "engram/base/text_file.h"
#include "engram/sources/image_folder_source.h"
#include "image_list.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fnmatch.h>
#include <map>
#include <sstream>

namespace engram::sources {
namespace {

namespace fs = std::filesystem;

bool isDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// The longest run of digits, without leading zeros; the first of equally long ones. The stem when there is
/// none.
std::string keyOf(const std::string& path) {
  const std::string stem = fs::path(path).stem().string();
  std::string best;
  for (auto at = stem.begin(); at != stem.end();) {
    const auto first = std::find_if(at, stem.end(), isDigit);
    at = std::find_if_not(first, stem.end(), isDigit);
    if (at - first > std::ssize(best)) best.assign(first, at);
  }
  if (best.empty()) return stem;
  return best.substr(std::min(best.find_first_not_of('0'), best.size() - 1));
}

std::map<std::string, std::string> byKey(const std::vector<std::string>& paths) {
  std::map<std::string, std::string> images;
  for (const auto& path : paths) {
    const auto [at, isNew] = images.insert({keyOf(path), path});
    if (!isNew)
      throw base::Error(at->second + " and " + path + " have the same number " + at->first +
                        "; left and right images are paired by the longest number in their names");
  }
  return images;
}

/// The stamps as they are written, each a finite number.
std::vector<std::string> readStamps(const std::string& path, std::size_t wanted) {
  std::istringstream in(base::readTextFile(path));
  std::vector<std::string> stamps;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    line.erase(line.find_last_not_of(" \t\r") + 1);
    line.erase(0, line.find_first_not_of(" \t"));
    if (line.empty() || line.front() == '#') continue;
    if (!secondsOf(line, StampUnit::kSeconds))
      throw base::Error(path + ":" + std::to_string(number) + ": " + base::quoted(line) +
                        " is not one stamp");
    stamps.push_back(line);
  }
  if (stamps.size() != wanted)
    throw base::Error(path + ": " + std::to_string(stamps.size()) + " stamps for " + std::to_string(wanted) +
                      " images; there must be one line for each");
  return stamps;
}

/// Gives every left image its right one; says which had none.
std::string pairUp(std::vector<ImageEntry>& entries, const std::vector<std::string>& rights) {
  std::vector<std::string> lefts;
  for (const auto& entry : entries) lefts.push_back(entry.image);
  byKey(lefts);  // refuses ambiguous names
  auto images = byKey(rights);
  std::string first;
  for (auto& entry : entries) {
    auto node = images.extract(keyOf(entry.image));
    if (node) entry.right = node.mapped();
    if (!node && first.empty()) first = entry.image;
  }
  const std::size_t all = entries.size();
  std::erase_if(entries, [](const ImageEntry& entry) { return entry.right.empty(); });
  std::string notice;
  if (entries.size() < all)
    notice = std::to_string(all - entries.size()) +
             " left image(s) left out: no right image with their number, " + "the first is " + first;
  if (!images.empty())
    notice += (notice.empty() ? "" : "; ") + std::to_string(images.size()) +
              " right image(s) left out: no left image with their number, the first is " +
              images.begin()->second;
  return notice;
}

}  // namespace

std::vector<std::string> findImages(const std::string& images) {
  const fs::path path(images);
  const std::string pattern = path.filename().string();
  const bool isPattern = pattern.find_first_of("*?") != std::string::npos;
  fs::path folder = isPattern ? path.parent_path() : path;
  if (folder.empty()) folder = ".";
  std::vector<std::string> found;
  for (const auto& name : listImages(folder.string()))
    if (!isPattern || fnmatch(pattern.c_str(), name.c_str(), 0) == 0)
      found.push_back((folder / name).string());
  if (found.empty()) throw base::Error(images + ": no image fits this pattern");
  return found;
}

double stampInName(const std::string& name) {
  const std::string stem = fs::path(name).stem().string();
  for (auto at = stem.begin(); at != stem.end();) {
    const auto first = std::find_if(at, stem.end(), isDigit);
    at = std::find_if_not(first, stem.end(), isDigit);
    const std::string digits(first, at);
    if (digits.size() == 10 && at != stem.end() && *at == '.') {
      const auto end = std::find_if_not(at + 1, stem.end(), isDigit);
      return std::stod(digits + std::string(at, end));
    }
    if (digits.size() == 10) return std::stod(digits);
    if (digits.size() == 13 || digits.size() == 16 || digits.size() == 19)
      return std::stod(digits.substr(0, 10) + "." + digits.substr(10));
  }
  throw base::Error(name + ": its name holds no Unix time (10, 13, 16 or 19 digits)");
}

std::unique_ptr<ImageListSource> openImagePairs(const std::string& left, const std::string& right,
                                                const std::string& stamps, StampUnit unit) {
  std::vector<ImageEntry> entries;
  for (const auto& path : findImages(left)) {
    const std::string name = fs::path(path).filename().string();
    const double stamp = stamps == "names" ? stampInName(name) : static_cast<double>(entries.size());
    entries.push_back({path, {}, name, stamp, {}});
  }
  ImageListNotes notes;
  if (!stamps.empty() && stamps != "names")
    notes.reading = setStamps(entries, readStamps(stamps, entries.size()), unit);
  if (!right.empty()) notes.problem = pairUp(entries, findImages(right));
  if (entries.empty())
    throw base::Error(left + " and " + right + ": no two images belong together; " + notes.problem);
  return makeListSource(left, std::move(entries), std::move(notes));
}

}  // namespace engram::sources
