// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/truth.h"

#include "engram/base/error.h"
#include "engram/base/text.h"
#include "engram/base/text_file.h"
#include "text_lines.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace engram::evaluation {
namespace {

bool isDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

std::optional<TruthKind> kindOf(const std::string& header) {
  const auto names = splitFields(header, ',');
  using Names = std::vector<std::string>;
  if (names == Names{"query_index", "first_ref_index", "last_ref_index"} ||
      names == Names{"query", "first", "last"})
    return TruthKind::kRanges;
  if (names == Names{"image", "matches"}) return TruthKind::kMatches;
  if (names == Names{"a", "b"} || names == Names{"a", "b", "source"}) return TruthKind::kLinks;
  if (isPoseLine(header)) return TruthKind::kPoses;
  return std::nullopt;
}

bool within(const std::map<std::int64_t, std::set<std::int64_t>>& related, std::int64_t from, std::int64_t to,
            int hops) {
  std::set<std::int64_t> reached{from}, front{from};
  for (int h = 0; h < hops && !front.empty(); ++h) {
    std::set<std::int64_t> next;
    for (const auto place : front)
      if (const auto at = related.find(place); at != related.end())
        for (const auto neighbour : at->second)
          if (reached.insert(neighbour).second) next.insert(neighbour);
    front = std::move(next);
  }
  return reached.count(to) > 0;
}

}  // namespace

const char* toString(TruthKind kind) {
  switch (kind) {
    case TruthKind::kRanges:
      return "ranges of frames";
    case TruthKind::kMatches:
      return "matching images";
    case TruthKind::kLinks:
      return "links between images";
    case TruthKind::kPoses:
      return "poses";
  }
  return "?";
}

bool isFileName(const std::string& label) {
  std::string extension = std::filesystem::path(label).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static const std::set<std::string> known{".jpg", ".jpeg", ".png",  ".pgm", ".ppm",
                                           ".bmp", ".tif",  ".tiff", ".webp"};
  return known.count(extension) > 0 || (!label.empty() && std::all_of(label.begin(), label.end(), isDigit));
}

std::optional<std::int64_t> numberInFileName(const std::string& label) {
  const std::string stem = std::filesystem::path(label).stem().string();
  const auto last = std::find_if(stem.rbegin(), stem.rend(), isDigit).base();
  const auto first = std::find_if_not(std::make_reverse_iterator(last), stem.rend(), isDigit).base();
  if (first == last || last - first > 18) return std::nullopt;
  return std::stoll(std::string(first, last));
}

Truth Truth::load(const std::string& path, const TruthOptions& options) {
  return parse(base::readTextFile(path), path, options);
}

Truth Truth::parse(const std::string& text, const std::string& name, const TruthOptions& options) {
  if (options.margin < 0 || !(options.radius > 0) || !(options.maxGap > 0))
    throw base::Error("--truth-margin must be >= 0, the radius and the gap of the truth > 0");
  const auto lines = contentLines(text, name);
  if (lines.empty()) refuse(name, "is empty");
  const auto kind = kindOf(lines.front().text);
  if (!kind)
    refuse(lines.front().origin,
           base::quoted(lines.front().text) +
               " is no known form of truth; known are the headers query,first,last and "
               "image,matches and a,b[,source], and poses of TUM (8 numbers a line), EuRoC "
               "(csv) and KITTI (12 numbers a line)");
  Truth truth;
  truth.kind_ = *kind;
  truth.name_ = name;
  truth.options_ = options;
  if (*kind == TruthKind::kPoses) {
    truth.poses_ = parsePoses(text, name);
    return truth;
  }
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto& [content, origin] = lines[i];
    if (*kind == TruthKind::kRanges) truth.addRange(content, origin);
    if (*kind == TruthKind::kMatches) truth.addMatches(content, origin);
    if (*kind == TruthKind::kLinks) truth.addLink(content, origin);
  }
  if (lines.size() == 1) refuse(name, "holds a header only");
  return truth;
}

void Truth::addRange(const std::string& text, const std::string& origin) {
  const auto fields = splitFields(text, ',');
  if (fields.size() != 3) refuse(origin, "expected query,first,last, found " + base::quoted(text));
  const auto query = parseInteger(fields[0], origin, "query");
  const auto first = parseInteger(fields[1], origin, "first");
  const auto last = parseInteger(fields[2], origin, "last");
  if (query < 0 || first < 0) refuse(origin, "indices count from 0");
  if (last < first) refuse(origin, "the last reference lies before the first");
  keys_.insert(query);
  if (!ranges_.insert({query, {first, last}}).second)
    refuse(origin, "query " + base::printable(fields[0]) + " has a line already");
}

void Truth::addMatches(const std::string& text, const std::string& origin) {
  const auto fields = splitFields(text, ',');
  if (fields.size() != 2) refuse(origin, "expected image,matches, found " + base::quoted(text));
  const auto image = parseInteger(fields[0], origin, "image");
  keys_.insert(image);
  for (const auto& field : splitFields(fields[1], ' ')) {
    const auto match = parseInteger(field, origin, "match");
    keys_.insert(match);
    related_[image].insert(match);
    related_[match].insert(image);
  }
}

void Truth::addLink(const std::string& text, const std::string& origin) {
  const auto fields = splitFields(text, ',');
  if (fields.size() != 2 && fields.size() != 3)
    refuse(origin, "expected a,b or a,b,source, found " + base::quoted(text));
  const auto a = parseInteger(fields[0], origin, "a");
  const auto b = parseInteger(fields[1], origin, "b");
  keys_.insert({a, b});
  related_[a].insert(b);
  related_[b].insert(a);
}

/// The number in the file name; for matches without file names the image's place in the sequence, from 1.
std::optional<std::int64_t> Truth::imageNumber(const FrameRef& frame) const {
  if (isFileName(frame.label)) return numberInFileName(frame.label);
  if (kind_ == TruthKind::kMatches) return static_cast<std::int64_t>(frame.index) + 1;
  return std::nullopt;
}

std::optional<std::int64_t> Truth::keyOf(const FrameRef& frame) const {
  if (kind_ == TruthKind::kPoses) return std::nullopt;
  if (kind_ == TruthKind::kRanges) return static_cast<std::int64_t>(frame.index);
  return imageNumber(frame);
}

std::size_t Truth::posesWithin(double first, double last) const {
  const auto inside = [&](const StampedPose& pose) {
    return pose.stamp >= first - options_.maxGap && pose.stamp <= last + options_.maxGap;
  };
  return static_cast<std::size_t>(std::count_if(poses_.begin(), poses_.end(), inside));
}

std::pair<double, double> Truth::stampRange() const {
  return poses_.empty() ? std::pair(0.0, 0.0) : std::pair(poses_.front().stamp, poses_.back().stamp);
}

Verdict Truth::judgeNumbers(std::int64_t query, std::int64_t place) const {
  if (query == place) return Verdict::kRight;
  const auto at = related_.find(query);
  if (kind_ == TruthKind::kLinks) {
    if (at == related_.end()) return Verdict::kUnknown;
    return within(related_, query, place, 1 + options_.margin) ? Verdict::kRight : Verdict::kWrong;
  }
  if (at == related_.end()) return Verdict::kWrong;
  const auto nearest = at->second.lower_bound(place - options_.margin);
  return nearest != at->second.end() && *nearest <= place + options_.margin ? Verdict::kRight
                                                                            : Verdict::kWrong;
}

Verdict Truth::judge(const FrameRef& query, const FrameRef& place) const {
  if (kind_ == TruthKind::kPoses) {
    const auto at = position(query.stamp);
    if (!at || !place.position) return Verdict::kUnknown;
    return (*at - *place.position).norm() <= options_.radius ? Verdict::kRight : Verdict::kWrong;
  }
  if (kind_ == TruthKind::kRanges) {
    const auto range = ranges_.find(static_cast<std::int64_t>(query.index));
    if (range == ranges_.end()) return Verdict::kUnknown;
    const auto index = static_cast<std::int64_t>(place.index);
    const bool inside =
        index >= range->second.first - options_.margin && index <= range->second.second + options_.margin;
    return inside ? Verdict::kRight : Verdict::kWrong;
  }
  const auto queryNumber = imageNumber(query), placeNumber = imageNumber(place);
  if (!queryNumber || !placeNumber) return Verdict::kUnknown;
  return judgeNumbers(*queryNumber, *placeNumber);
}

bool Truth::answerable(const FrameRef& query) const {
  if (kind_ == TruthKind::kPoses) return position(query.stamp).has_value();
  if (kind_ == TruthKind::kRanges) return ranges_.count(static_cast<std::int64_t>(query.index)) > 0;
  const auto number = imageNumber(query);
  return number && related_.count(*number) > 0;
}

std::optional<Eigen::Vector3d> Truth::position(double stamp) const {
  const auto pose = poseAt(poses_, stamp, options_.maxGap);
  if (!pose) return std::nullopt;
  return pose->translation();
}

}  // namespace engram::evaluation
