// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "picture_pairs.h"

#include "engram/base/text.h"
#include "engram/charts/markup.h"
#include "engram/map/picture.h"

#include <algorithm>
#include <map>
#include <span>
#include <vector>

namespace engram::exporters {
namespace {

constexpr std::size_t kMostPairs = 24;  // a page of a few hundred kilobytes

struct Pair {
  const types::FrameReport* image = nullptr;
  const std::vector<std::uint8_t>* now = nullptr;  // JPEG
  const map::View* before = nullptr;
};

std::string base64(std::span<const std::uint8_t> bytes) {
  static const char* const kSigns = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < n ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= n ? kSigns[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

/// The views with a picture that is sound, of each place in their order of time.
std::map<map::PlaceId, std::vector<const map::View*>> picturesOf(const map::TopologicalMap& map) {
  std::map<map::PlaceId, std::vector<const map::View*>> pictures;
  for (const auto& [id, view] : map.views())
    if (!view.jpeg.empty() && map::brokenPicture(view.jpeg).empty()) pictures[view.place].push_back(&view);
  return pictures;
}

/// A map of views has closed the loop to an older view: the best guess.
map::PlaceId knownPlace(const types::FrameReport& r) {
  return r.outcome == types::Outcome::kNewPlace ? r.bestGuess : r.place;
}

/// The picture of an image: among those at hand, or the thumbnail of a view that it became.
const std::vector<std::uint8_t>* pictureOf(const types::FrameReport& r, const Pictures& atHand,
                                           const std::vector<const map::View*>& views) {
  if (const auto found = atHand.find({r.index, r.stamp}); found != atHand.end()) return &found->second;
  for (const map::View* view : views)
    if (view->frameIndex == r.index && view->stamp == r.stamp) return &view->jpeg;
  return nullptr;
}

std::vector<Pair> pairsOf(const HtmlReport& report, bool closures) {
  const auto pictures = picturesOf(*report.map);
  std::vector<Pair> pairs;
  for (const auto& r : report.records) {
    if (closures ? !r.closure : r.outcome != types::Outcome::kRecognised) continue;
    const auto here = pictures.find(r.place), there = pictures.find(knownPlace(r));
    if (there == pictures.end()) continue;
    const std::vector<const map::View*> none;
    Pair pair{.image = &r,
              .now = pictureOf(r, report.pictures, here == pictures.end() ? none : here->second),
              .before = there->second.front()};
    if (pair.now != nullptr && pair.now != &pair.before->jpeg) pairs.push_back(pair);
  }
  return pairs;
}

std::string picture(const std::vector<std::uint8_t>& jpeg, const std::string& words) {
  return "<img alt=\"" + charts::escaped(words) + "\" src=\"data:image/jpeg;base64," + base64(jpeg) +
         "\" style=\"width:49%;max-width:320px\"/>";
}

std::string figure(const Pair& pair) {
  const types::FrameReport& r = *pair.image;
  const std::string now = "image " + std::to_string(r.index) + " (" + r.label + ")";
  const std::string before = "place " + std::to_string(pair.before->place.value) + ", as seen in drive " +
                             std::to_string(pair.before->session + 1) + " (" + pair.before->label + ")";
  std::string words = "Left: " + now + ". Right: " + before + ".";
  const auto best = std::find_if(r.hypotheses.begin(), r.hypotheses.end(),
                                 [&](const auto& h) { return h.place == pair.before->place; });
  if (best != r.hypotheses.end() && best->inliers >= 0)
    words += " " + std::to_string(best->inliers) + " matches agree with one motion of the camera.";
  return "<figure>" + picture(*pair.now, now) + " " + picture(pair.before->jpeg, before) + "<figcaption>" +
         charts::escaped(words) + "</figcaption></figure>\n";
}

}  // namespace

void addPicturePairs(charts::Page& page, const HtmlReport& report) {
  auto pairs = pairsOf(report, true);
  const bool closures = !pairs.empty();
  if (!closures) pairs = pairsOf(report, false);
  if (pairs.empty()) return;
  page.heading(closures ? "Closures" : "Recognised places");
  const std::size_t every = (pairs.size() + kMostPairs - 1) / kMostPairs;
  page.note(base::counted(pairs.size(), "pair") +
            (every > 1 ? ", one in " + std::to_string(every) + " shown" : "") +
            ". Do the two pictures of a pair show one spot? The right one is the first that the map keeps of "
            "the place.");
  page.beginRow();
  for (std::size_t i = 0; i < pairs.size(); i += every) page.append(figure(pairs[i]));
  page.endRow();
}

}  // namespace engram::exporters
