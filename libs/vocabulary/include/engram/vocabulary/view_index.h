// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/vocabulary/vocabulary_tree.h"

#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace engram::vocabulary {

/// How much a view in the index looks like the image.
struct ViewVote {
  base::ViewId view;
  double score = 0;
  bool operator==(const ViewVote&) const = default;
};

/// Inverted files at the leaves of a vocabulary tree (Nistér & Stewénius, K-14): which view of thousands may
/// an image show? Views come and go at any time, and the weights of the words follow. Equal contents give
/// equal votes, bit by bit, whatever additions and removals led to them.
///
///     const auto words = index.tree().wordsOf(features.descriptors);
///     for (const auto& vote : index.query(words)) … geometry …
///     index.add(view, words);
class ViewIndex {
 public:
  using Words = std::span<const base::WordId>;

  struct Described {
    base::ViewId view;
    const types::Descriptors* descriptors = nullptr;
  };

  explicit ViewIndex(VocabularyTree tree);
  /// With these views in it: a map indexed anew by a tree that has grown from it.
  /// @throws base::Error when they do not fit the tree, std::invalid_argument as add().
  ViewIndex(VocabularyTree tree, std::span<const Described> views);

  /// Adds a view with the words of its features, in any order; none are legal.
  /// @throws std::invalid_argument when the view is known already or invalid, or a word is none of the tree.
  void add(base::ViewId view, Words words);
  /// Forgets a view; an unknown one is no error.
  void remove(base::ViewId view);

  /// The views that share words with an image, best first, at most so many (ties: the lower number).
  ///
  /// A word w that the image has q times and the view v times adds min(q, v) log(N / n_w), with n_w of the N
  /// views that have it: about the number of features that could match, rare ones counting more. Nistér &
  /// Stewénius scale both sides to unit length first; we do not, since geometry then asks for a number of
  /// inliers (K-15), not a share: on real images a poor view of another place no longer gets ahead.
  std::vector<ViewVote> query(Words words, std::size_t most = 15) const;

  const VocabularyTree& tree() const { return tree_; }
  std::size_t size() const { return views_.size(); }
  bool contains(base::ViewId view) const { return views_.contains(view); }
  std::size_t bytes() const;  ///< memory, without the tree

 private:
  struct Count {
    std::uint32_t word = 0, times = 0;
  };
  struct Posting {
    std::uint32_t slot = 0, times = 0;
  };
  struct View {
    std::uint32_t slot = 0;
    std::vector<Count> counts;  // by rising word
  };
  std::vector<Count> counted(Words words) const;

  VocabularyTree tree_;
  std::map<base::ViewId, View> views_;
  std::vector<base::ViewId> slots_;  // the view of each slot; invalid: free
  std::vector<std::uint32_t> freeSlots_;
  std::vector<std::vector<Posting>> postings_;  // of each word, in no order
};

}  // namespace engram::vocabulary
