// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/truth_match.h"

#include <algorithm>
#include <cstdio>

namespace engram::evaluation {
namespace {

/// What a truth is made of, for a message.
std::string entriesOf(TruthKind kind) {
  switch (kind) {
    case TruthKind::kRanges:
      return "queries (numbers of images in their order, from 0)";
    case TruthKind::kMatches:
    case TruthKind::kLinks:
      return "images (numbers in file names)";
    case TruthKind::kPoses:
      return "poses (by their stamps)";
  }
  return "entries";
}

/// Where the stamps lie, and the unit that those of the truth seem to have.
std::string stampsOf(const Truth& truth, double first, double last) {
  const auto [from, to] = truth.stampRange();
  char text[200];
  std::snprintf(text, sizeof text, "; its stamps are %.3f to %.3f, those of the images %.3f to %.3f s", from,
                to, first, last);
  std::string said = text;
  using Unit = std::pair<double, const char*>;
  for (const auto& [factor, name] : {Unit{1e3, "milli"}, Unit{1e6, "micro"}, Unit{1e9, "nano"}})
    if (from / factor <= last + 1 && to / factor >= first - 1 && from > 10 * last)
      said += std::string(": they seem to be ") + name + "seconds";
  return said;
}

}  // namespace

void TruthMatch::addImage(const Truth& truth, const FrameRef& image) {
  ++images_;
  firstStamp_ = std::min(firstStamp_, image.stamp);
  lastStamp_ = std::max(lastStamp_, image.stamp);
  if (truth.kind() == TruthKind::kPoses) {
    spokenOf_ += truth.position(image.stamp) ? 1 : 0;
    return;
  }
  if (truth.goesByName() && !isFileName(image.label) && unnamed_++ == 0) unnamedLabel_ = image.label;
  const auto key = truth.keyOf(image);
  if (!key || !truth.holds(*key)) return;
  ++spokenOf_;
  keys_.insert(*key);
}

void TruthMatch::addPlace(const Truth& truth, const FrameRef& place) {
  if (!truth.goesByName()) return;
  if (const auto key = truth.keyOf(place); key && truth.holds(*key)) keys_.insert(*key);
}

std::size_t TruthMatch::occurring(const Truth& truth) const {
  if (truth.kind() == TruthKind::kPoses) return truth.posesWithin(firstStamp_, lastStamp_);
  return keys_.size();
}

std::string TruthMatch::problem(const Truth& truth) const {
  if (images_ == 0) return {};
  const std::size_t occurs = occurring(truth), all = truth.size();
  if (spokenOf_ > 0 && (2 * occurs >= all || 2 * spokenOf_ >= images_)) return {};
  std::string text = truth.name() + ": is not the truth of these images: of its " + std::to_string(all) +
                     " " + entriesOf(truth.kind()) + " " + std::to_string(occurs) +
                     " occur here, and it tells of " + std::to_string(spokenOf_) + " of " +
                     std::to_string(images_) + " images";
  if (truth.kind() == TruthKind::kPoses) text += stampsOf(truth, firstStamp_, lastStamp_);
  if (unnamed_ > 0)
    text += "; it goes by the names of image files, and " + std::to_string(unnamed_) +
            " images have none (their label is '" + unnamedLabel_ + "'): engram-rawlog pack keeps them";
  return text;
}

std::string TruthMatch::notice(const Truth& truth) const {
  if (truth.kind() != TruthKind::kMatches || unnamed_ == 0) return {};
  return truth.name() + ": goes by the numbers in the names of image files, and " + std::to_string(unnamed_) +
         " images have no names (their label is '" + unnamedLabel_ +
         "'): they were counted from 1 in their order; engram-rawlog pack keeps names";
}

}  // namespace engram::evaluation
