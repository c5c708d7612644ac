// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/vocabulary/vocabulary_tree.h"

#include "descriptor_distance.h"
#include "engram/base/error.h"
#include "layout_text.h"
#include "tree_trainer.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace engram::vocabulary {

using types::DescriptorKind;
using types::Descriptors;

namespace {
constexpr int kMostBranches = 255;  // the number of children is one byte in files
}

void TreeParams::describe(base::Params& p) {
  p.add("branching", branching, "children of a node of the vocabulary tree", {2, kMostBranches});
  p.add("depth", depth, "levels of the tree below its root, at most", {1, 20});
  p.add("min_split", min_split, "training descriptors that a node needs to have children", {2, 1e6});
  p.add("max_training", max_training, "descriptors that the tree is trained on, drawn by the seed", {1, 1e8});
  p.add("iterations", iterations, "of k-means in each node, at most", {1, 1000});
  p.add("beam", beam, "nodes of each level that are looked into for the word of a descriptor", {1, 1000});
  p.add("seed", seed, "of the draw and of k-means", {0, std::numeric_limits<int>::max()});
}

VocabularyTree VocabularyTree::train(std::span<const Descriptors* const> images, const TreeParams& params,
                                     const Progress& progress) {
  return TreeTrainer(sample(images, params), params).train(progress);
}

/// Memory of one search, kept for the next.
struct VocabularyTree::Search {
  using Branch = std::pair<float, std::uint32_t>;  // distance, node
  std::vector<Branch> beam, next;
  float distances[kMostBranches];
};

std::uint32_t VocabularyTree::leafOf(const std::byte* descriptor, Search& search) const {
  auto& [beam, next, distances] = search;
  Search::Branch leaf(std::numeric_limits<float>::infinity(), 0);
  beam.assign(1, {0.0f, 0});
  while (!beam.empty()) {
    next.clear();
    for (const auto& [unused, n] : beam) {
      const Node& node = nodes_[n];
      if (node.children > 0) distancesTo(descriptor, centres_, node.first - 1, node.children, distances);
      for (std::uint32_t c = 0; c < node.children; ++c) {
        const Search::Branch branch(distances[c], node.first + c);
        if (nodes_[branch.second].children > 0)
          next.push_back(branch);
        else
          leaf = std::min(leaf, branch);
      }
    }
    const std::size_t kept = std::min(next.size(), static_cast<std::size_t>(params_.beam));
    std::partial_sort(next.begin(), next.begin() + static_cast<std::ptrdiff_t>(kept), next.end());
    next.resize(kept);
    beam.swap(next);
  }
  return leaf.second;  // the root, of a tree without children
}

std::vector<base::WordId> VocabularyTree::wordsOf(const Descriptors& descriptors) const {
  std::vector<base::WordId> result(descriptors.size());
  if (descriptors.empty()) return result;
  const bool quantise = kind() == DescriptorKind::kInt8 && descriptors.kind() == DescriptorKind::kFloat;
  const Descriptors rows = quantise ? types::quantised(descriptors) : descriptors;
  if (!rows.sameLayout(centres_))
    throw base::Error("the vocabulary was trained on descriptors of " + layoutText(centres_) +
                      ", the image has descriptors of " + layoutText(rows) +
                      ": train one with the extractor that is in use");
  Search search;
  for (std::size_t i = 0; i < rows.size(); ++i)
    result[i] = base::WordId(nodes_[leafOf(rows.row(i).data(), search)].first);
  return result;
}

std::size_t VocabularyTree::bytes() const { return nodes_.size() * sizeof(Node) + centres_.bytes().size(); }

}  // namespace engram::vocabulary
