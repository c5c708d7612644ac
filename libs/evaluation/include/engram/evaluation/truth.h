// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/evaluation/trajectory.h"

#include <Eigen/Core>

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace engram::evaluation {

/// What truth can be asked about: an image that was located, or the image that made a place.
struct FrameRef {
  std::uint64_t index = 0;  ///< running number in its own source, from 0
  std::string label;        ///< file name of the image; its number counts in some forms of truth
  double stamp = 0.0;       ///< [s]
  std::optional<Eigen::Vector3d>
      position;  ///< [m] of the image that made the place, in the frame of the truth
};

enum class Verdict : std::uint8_t {
  kRight,
  kWrong,
  kUnknown,  ///< the truth says nothing about this query: it must not count
};

/// The form of a truth file, known from its header.
enum class TruthKind : std::uint8_t {
  kRanges,   ///< `query_index,first_ref_index,last_ref_index` or `query,first,last`: indices from 0, ends
             ///< included
  kMatches,  ///< `image,matches`: numbers of image files; the matches are separated by white space
  kLinks,    ///< `a,b[,source]`: neighbours, numbers of image files; a place is right for itself and its
             ///< neighbours
  kPoses,    ///< poses of the query drive, in a form of readPoses()
};

const char* toString(TruthKind kind);

struct TruthOptions {
  int margin = 0;       ///< widens ranges and matches by so many frames, links by so many hops
  double radius = 1.0;  ///< [m] for poses
  double maxGap = 1.0;  ///< [s] for poses: no truth in longer gaps
};

/// Which answers are right.
class Truth {
 public:
  /// Throws base::Error with file and line for a form that is not known or a line that does not fit it.
  static Truth load(const std::string& path, const TruthOptions& options = {});
  static Truth parse(const std::string& text, const std::string& name, const TruthOptions& options = {});

  TruthKind kind() const { return kind_; }
  /// Of the file, for messages.
  const std::string& name() const { return name_; }

  /// Whether it knows images by the numbers in the names of their files.
  bool goesByName() const { return kind_ == TruthKind::kMatches || kind_ == TruthKind::kLinks; }
  /// By what the truth would know this image: its number or its index; none for poses, and when it has no
  /// number.
  std::optional<std::int64_t> keyOf(const FrameRef& frame) const;
  bool holds(std::int64_t key) const { return keys_.contains(key); }
  /// How many images, queries or poses it holds.
  std::size_t size() const { return kind_ == TruthKind::kPoses ? poses_.size() : keys_.size(); }
  /// How many of its poses have stamps [s] from `first` to `last`, give or take TruthOptions::maxGap.
  std::size_t posesWithin(double first, double last) const;
  /// Of its poses [s]; 0 and 0 when it has none.
  std::pair<double, double> stampRange() const;
  const TruthOptions& options() const { return options_; }

  /// Whether it is right to find `query` at the place that `place` made.
  ///
  /// An image that `image,matches` does not list shows no known place: all answers are wrong. The form is
  /// symmetric. Poses compare the true position of the query with `place.position`; without either the
  /// verdict is unknown.
  Verdict judge(const FrameRef& query, const FrameRef& place) const;

  /// Whether any answer can be right for this query, were all places known. False for images that show a new
  /// place.
  bool answerable(const FrameRef& query) const;

  /// [m] True position at a stamp, for poses.
  std::optional<Eigen::Vector3d> position(double stamp) const;

 private:
  void addRange(const std::string& text, const std::string& origin);
  void addMatches(const std::string& text, const std::string& origin);
  void addLink(const std::string& text, const std::string& origin);
  std::optional<std::int64_t> imageNumber(const FrameRef& frame) const;
  Verdict judgeNumbers(std::int64_t query, std::int64_t place) const;

  std::string name_;
  std::set<std::int64_t> keys_;  ///< all that it names, but for references of ranges
  TruthKind kind_ = TruthKind::kRanges;
  TruthOptions options_;
  std::map<std::int64_t, std::pair<std::int64_t, std::int64_t>> ranges_;
  std::map<std::int64_t, std::set<std::int64_t>> related_;  ///< matches or links, both ways
  Trajectory poses_;
};

/// Whether a label is the name of an image file: one with such an extension, or a bare number. Labels of
/// sensors, such as CAMERA1, are none.
bool isFileName(const std::string& label);

/// The last run of digits in the file name without its folder and extension: 92 for `pano/IMG_092.jpg`.
std::optional<std::int64_t> numberInFileName(const std::string& label);

}  // namespace engram::evaluation
