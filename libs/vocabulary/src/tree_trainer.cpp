// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tree_trainer.h"

#include "engram/base/error.h"
#include "kmeans.h"
#include "layout_text.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

namespace engram::vocabulary {
namespace {

using types::DescriptorKind;
using types::Descriptors;

constexpr std::uint64_t kDraw = ~std::uint64_t{0};  // stream of random numbers; nodes have theirs by number

/// kFloat and kInt8 descriptors are one kind: they are compared as kInt8 where both occur.
void requireOneLayout(std::span<const Descriptors* const> images) {
  const Descriptors* first = nullptr;
  const auto isBinary = [](const Descriptors* d) { return d->kind() == DescriptorKind::kBinary; };
  for (const Descriptors* d : images) {
    if (d->empty()) continue;
    if (first == nullptr) first = d;
    if (d->dim() != first->dim() || isBinary(d) != isBinary(first))
      throw base::Error("a vocabulary cannot be trained on descriptors of " + layoutText(*first) +
                        " and of " + layoutText(*d) + " together: use images of one extractor");
  }
  if (first == nullptr) throw base::Error("there are no descriptors to train a vocabulary on");
}

}  // namespace

Descriptors VocabularyTree::sample(std::span<const Descriptors* const> images, const TreeParams& params) {
  base::validate(params);
  requireOneLayout(images);
  std::uint64_t left = 0;
  bool quantise = false;
  for (const Descriptors* d : images) {
    left += d->size();
    quantise = quantise || (!d->empty() && d->kind() == DescriptorKind::kInt8);
  }
  base::Rng rng = base::Rng(static_cast<std::uint64_t>(params.seed)).fork(kDraw);
  auto wanted = static_cast<std::uint64_t>(params.max_training);
  Descriptors chosen;
  for (const Descriptors* image : images) {
    if (image->empty()) continue;
    const Descriptors rows = quantise ? types::quantised(*image) : *image;
    if (chosen.empty()) chosen = Descriptors(rows.kind(), rows.dim());
    for (std::size_t i = 0; i < rows.size(); ++i, --left) {
      // Knuth's selection sampling.
      if (rng.uniform() * static_cast<double>(left) >= static_cast<double>(wanted)) continue;
      chosen.append(rows.row(i));
      --wanted;
    }
  }
  return chosen;
}

TreeTrainer::TreeTrainer(Descriptors samples, const TreeParams& params)
    : samples_(std::move(samples)), rng_(static_cast<std::uint64_t>(params.seed)) {
  tree_.params_ = params;
  tree_.centres_ = Descriptors(samples_.kind(), samples_.dim());
}

/// Gives a node its children and each of these its rows; nothing when it stays a leaf.
std::vector<TreeTrainer::Rows> TreeTrainer::grow(std::uint32_t node, const Rows& rows) {
  const TreeParams& params = tree_.params_;
  if (rows.size() < static_cast<std::size_t>(params.min_split)) return {};
  Descriptors own(samples_.kind(), samples_.dim());
  own.reserve(rows.size());
  for (const std::uint32_t r : rows) own.append(samples_.row(r));
  const Clustering clusters = kMeans(own, params.branching, params.iterations, rng_.fork(node));
  const std::size_t k = clusters.centres.size();
  if (k < 2) return {};
  tree_.nodes_[node] = {static_cast<std::uint32_t>(tree_.nodes_.size()), static_cast<std::uint16_t>(k)};
  tree_.nodes_.resize(tree_.nodes_.size() + k);
  std::vector<Rows> parts(k);
  for (std::size_t c = 0; c < k; ++c) tree_.centres_.append(clusters.centres.row(c));
  for (std::size_t i = 0; i < rows.size(); ++i) parts[clusters.nearest[i]].push_back(rows[i]);
  return parts;
}

VocabularyTree TreeTrainer::train(const VocabularyTree::Progress& progress) {
  std::vector<Rows> level(1, Rows(samples_.size()));
  std::iota(level.front().begin(), level.front().end(), 0u);
  tree_.nodes_.resize(1);
  std::uint32_t first = 0;  // node of the first entry of the level
  for (int depth = 0; depth < tree_.params_.depth && !level.empty(); ++depth) {
    if (progress) progress(static_cast<double>(depth) / tree_.params_.depth);
    std::vector<Rows> next;
    for (std::size_t i = 0; i < level.size(); ++i)
      for (Rows& rows : grow(first + static_cast<std::uint32_t>(i), std::exchange(level[i], {})))
        next.push_back(std::move(rows));
    first += static_cast<std::uint32_t>(level.size());
    level = std::move(next);
  }
  for (auto& node : tree_.nodes_)
    if (node.children == 0) node.first = tree_.words_++;
  if (progress) progress(1.0);
  return std::move(tree_);
}

}  // namespace engram::vocabulary
