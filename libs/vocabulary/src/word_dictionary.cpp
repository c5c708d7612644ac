// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/vocabulary/word_dictionary.h"

#include "descriptor_distance.h"
#include "engram/base/parallel.h"
#include "layout_text.h"
#include "two_means.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace engram::vocabulary {
namespace {

using base::WordId;
using types::DescriptorKind;
using types::Descriptors;

constexpr std::size_t kLevelShare = 5;  // of the budget: a level of the tree; the leaves get all of it

}  // namespace

void WordParams::describe(base::Params& p) {
  p.add("max_distance", max_distance,
        "largest distance of a feature to its word, float descriptors of unit length (A-E14)", {0, 2});
  p.add("max_bits", max_bits, "the same for binary descriptors, as share of differing bits", {0, 1});
  p.add("checks", checks, "descriptors a feature is compared with, about; 0 compares with all words",
        {0, 1e8});
  p.add("leaf_size", leaf_size, "words of one leaf of the search tree", {8, 65536});
  p.add("branching", branching, "children of one inner node of it", {4, 65536});
}

WordDictionary::WordDictionary(const WordParams& params) : params_(params) { base::validate(params); }

Descriptors WordDictionary::converted(const Descriptors& d) const {
  const bool quantise = kind_ == DescriptorKind::kInt8 && d.kind() == DescriptorKind::kFloat;
  if (dim_ > 0 && ((d.kind() != kind_ && !quantise) || d.dim() != dim_))
    throw base::Error("the dictionary has words of " + layoutText(kind_, dim_) +
                      ", the image descriptors of " + layoutText(d) +
                      ": use the extractor that the map was made with");
  return quantise ? types::quantised(d) : d;
}

/// From what the kernels give to types::Match::distance.
float WordDictionary::scaled(float raw) const {
  if (kind_ == DescriptorKind::kBinary) return raw / static_cast<float>(dim_);
  return kind_ == DescriptorKind::kInt8 ? std::sqrt(raw) / types::kInt8Scale : std::sqrt(raw);
}

bool WordDictionary::isNear(float distance) const {
  return distance <= (kind_ == DescriptorKind::kBinary ? params_.max_bits : params_.max_distance);
}

std::vector<WordMatch> WordDictionary::lookup(const Descriptors& descriptors, int threads) const {
  constexpr std::size_t kChunk = 32;  // searches that share their scratch memory
  std::vector<WordMatch> matches(descriptors.size());
  if (descriptors.empty() || size() == 0) return matches;
  const Descriptors queries = converted(descriptors);
  base::parallelFor((queries.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    Search search;
    const std::size_t end = std::min(queries.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) matches[i] = nearest(queries.row(i).data(), search);
  });
  return matches;
}

WordMatch WordDictionary::nearest(const std::byte* query, Search& search) const {
  const auto budget = params_.checks == 0 ? std::numeric_limits<std::size_t>::max()
                                          : static_cast<std::size_t>(params_.checks);
  nearestLeaves(query, budget / kLevelShare, search);
  float best = std::numeric_limits<float>::infinity();
  std::uint32_t word = kNone;
  for (std::size_t b = 0, compared = 0; b < search.beam.size() && compared < budget; ++b) {
    // The next leaf is far away in memory: 6 to 9 % of a lookup among 100,000 words.
    if (b + 1 < search.beam.size()) __builtin_prefetch(nodes_[search.beam[b + 1].node].rows.row(0).data());
    const Node& leaf = nodes_[search.beam[b].node];
    search.distances.resize(leaf.ids.size());
    distancesTo(query, leaf.rows, search.distances.data());
    compared += leaf.ids.size();
    for (std::size_t i = 0; i < leaf.ids.size(); ++i) {
      const float d = search.distances[i];
      if (d > best || (d == best && leaf.ids[i] > word)) continue;
      best = d;
      word = leaf.ids[i];
    }
  }
  const float distance = scaled(best);
  return {isNear(distance) ? WordId(word) : WordId(), distance};
}

std::vector<WordId> WordDictionary::learn(const Descriptors& descriptors, std::span<const WordMatch> found) {
  if (found.size() != descriptors.size())
    throw std::invalid_argument("WordDictionary::learn: one match for each descriptor is needed");
  for (const WordMatch& m : found)
    if (m.found() && !contains(m.word))
      throw std::invalid_argument("WordDictionary::learn: a word was removed after the lookup");
  std::vector<WordId> words(descriptors.size());
  if (descriptors.empty()) return words;
  const Descriptors rows = converted(descriptors);
  kind_ = rows.kind();
  dim_ = rows.dim();
  Descriptors made(kind_, dim_);
  std::vector<WordId> madeIds;
  std::vector<float> distances;
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = found[i].word;
    if (words[i].valid()) continue;
    distances.resize(made.size());
    distancesTo(rows.row(i).data(), made, distances.data());
    const auto nearestOne = std::min_element(distances.begin(), distances.end());
    if (nearestOne != distances.end() && isNear(scaled(*nearestOne))) {
      words[i] = madeIds[static_cast<std::size_t>(nearestOne - distances.begin())];
      continue;
    }
    if (nextId_ == kNone) throw base::Error("the dictionary has used up its word numbers: start a new map");
    words[i] = WordId(nextId_++);
    insert(words[i].value, rows.row(i));
    made.append(rows.row(i));
    madeIds.push_back(words[i]);
  }
  return words;
}

}  // namespace engram::vocabulary
