// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// How the tree of WordDictionary grows, splits and shrinks.
#include "descriptor_distance.h"
#include "engram/vocabulary/word_dictionary.h"
#include "two_means.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace engram::vocabulary {
namespace {

using types::Descriptors;

constexpr std::size_t kBeamShare = 4;  // children compared for each one kept: nodes are seldom less full
constexpr int kInsertNodes = 2;        // opened in each level to find the leaf of a new word

/// Overwrites row i by the last one, in both arrays.
void eraseUnordered(std::vector<std::uint32_t>& ids, Descriptors& rows, std::size_t i) {
  const std::size_t last = ids.size() - 1;
  if (i != last) {
    ids[i] = ids[last];
    std::memcpy(rows.mutableRow(i), rows.row(last).data(), rows.rowBytes());
  }
  ids.pop_back();
  rows.resize(last);
}

std::size_t indexOf(const std::vector<std::uint32_t>& ids, std::uint32_t id) {
  return static_cast<std::size_t>(std::find(ids.begin(), ids.end(), id) - ids.begin());
}

}  // namespace

std::uint32_t WordDictionary::newNode(bool leaf) {
  if (freeNodes_.empty()) {
    freeNodes_.push_back(static_cast<std::uint32_t>(nodes_.size()));
    nodes_.emplace_back();
  }
  const std::uint32_t n = freeNodes_.back();
  freeNodes_.pop_back();
  nodes_[n] = {kNone, leaf, {}, Descriptors(kind_, dim_)};
  return n;
}

/// Tells what a node holds that the node holds it.
void WordDictionary::adopt(std::uint32_t n) {
  for (const std::uint32_t id : nodes_[n].ids) {
    if (nodes_[n].leaf)
      leafOf_[base::WordId(id)] = n;
    else
      nodes_[id].parent = n;
  }
}

/// Down the tree, level by level. Of each level the nodes nearest to the query are opened, until `most`
/// children have been compared; the beam ends as leaves, nearest first. Whole levels are ranked, not branches
/// of several levels against each other: a small cluster is nearer to the query than the large one that holds
/// the answer.
void WordDictionary::nearestLeaves(const std::byte* query, std::size_t most, Search& search) const {
  auto& [beam, next, distances] = search;
  beam.assign(1, {0.0f, 0, root_});
  while (!nodes_[beam.front().node].leaf) {
    next.clear();
    for (const Branch& b : beam) {
      const Node& node = nodes_[b.node];
      distances.resize(node.ids.size());
      distancesTo(query, node.rows, distances.data());
      for (std::size_t i = 0; i < node.ids.size(); ++i)
        next.push_back({distances[i], static_cast<std::uint32_t>(next.size()), node.ids[i]});
      if (next.size() >= most) break;
    }
    const std::size_t kept = std::min(next.size(), most / kBeamShare + 1);
    std::partial_sort(next.begin(), next.begin() + static_cast<std::ptrdiff_t>(kept), next.end());
    next.resize(kept);
    beam.swap(next);
  }
}

void WordDictionary::insert(std::uint32_t word, std::span<const std::byte> row) {
  if (root_ == kNone) root_ = newNode(true);
  Search search;
  nearestLeaves(row.data(), static_cast<std::size_t>(kInsertNodes * params_.branching), search);
  const std::uint32_t at = search.beam.front().node;
  nodes_[at].ids.push_back(word);
  nodes_[at].rows.append(row);
  leafOf_[base::WordId(word)] = at;
  split(at);
}

/// Halves a node that is too full, and the nodes above it that become so.
void WordDictionary::split(std::uint32_t n) {
  const auto capacity = static_cast<std::size_t>(nodes_[n].leaf ? params_.leaf_size : params_.branching);
  if (nodes_[n].ids.size() <= capacity) return;
  const std::uint32_t sibling = newNode(nodes_[n].leaf);
  if (n == root_) {
    root_ = newNode(false);
    nodes_[root_].ids.push_back(n);
    nodes_[root_].rows.resize(1);
    nodes_[n].parent = root_;
  }
  const Node old = std::move(nodes_[n]);
  const TwoMeans halves = twoMeans(old.rows);
  nodes_[n] = {old.parent, old.leaf, {}, Descriptors(kind_, dim_)};
  nodes_[sibling].parent = old.parent;
  for (std::size_t i = 0; i < old.ids.size(); ++i) {
    Node& half = nodes_[halves.side[i] == 0 ? n : sibling];
    half.ids.push_back(old.ids[i]);
    half.rows.append(old.rows.row(i));
  }
  adopt(sibling);
  Node& parent = nodes_[old.parent];
  std::memcpy(parent.rows.mutableRow(indexOf(parent.ids, n)), halves.means.row(0).data(),
              old.rows.rowBytes());
  parent.ids.push_back(sibling);
  parent.rows.append(halves.means.row(1));
  split(old.parent);
}

/// Takes a node out of the tree, and its ancestors with it as far as they hold nothing else.
void WordDictionary::detach(std::uint32_t n) {
  const std::uint32_t above = nodes_[n].parent;
  nodes_[n] = {};
  freeNodes_.push_back(n);
  if (n == root_) {
    root_ = kNone;
    return;
  }
  Node& parent = nodes_[above];
  eraseUnordered(parent.ids, parent.rows, indexOf(parent.ids, n));
  if (parent.ids.empty()) return detach(above);
  while (!nodes_[root_].leaf && nodes_[root_].ids.size() == 1) {
    freeNodes_.push_back(std::exchange(root_, nodes_[root_].ids.front()));
    nodes_[freeNodes_.back()] = {};
    nodes_[root_].parent = kNone;
  }
}

void WordDictionary::remove(base::WordId word) {
  const auto entry = leafOf_.find(word);
  if (entry == leafOf_.end()) throw std::invalid_argument("WordDictionary::remove: no such word");
  const std::uint32_t n = entry->second;
  leafOf_.erase(entry);
  Node& leaf = nodes_[n];
  eraseUnordered(leaf.ids, leaf.rows, indexOf(leaf.ids, word.value));
  // A leaf that is nearly empty costs a search as much as a full one: its words move to other leaves.
  const bool sparse = n != root_ && leaf.ids.size() < static_cast<std::size_t>(params_.leaf_size) / 8;
  if (!sparse && !leaf.ids.empty()) return;
  const Node left = std::move(leaf);
  nodes_[n].parent = left.parent;
  detach(n);
  for (std::size_t i = 0; i < left.ids.size(); ++i) insert(left.ids[i], left.rows.row(i));
}

}  // namespace engram::vocabulary
