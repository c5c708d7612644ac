// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/ids.h"
#include "engram/base/params.h"
#include "engram/types/features.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace engram::vocabulary {

/// Section `[vocabulary]`: how a vocabulary tree is trained.
struct TreeParams {
  int branching = 10;         ///< children of a node
  int depth = 6;              ///< levels below the root, at most
  int min_split = 20;         ///< training descriptors that a node needs to have children
  int max_training = 200000;  ///< descriptors that the tree is trained on, drawn by the seed
  int iterations = 10;        ///< of k-means in each node, at most
  int beam = 3;               ///< nodes of each level that are looked into for the word of a descriptor
  int seed = 1;

  void describe(base::Params& p);
  bool operator==(const TreeParams&) const = default;
};

/// The vocabulary tree of Nistér & Stewénius (2006): hierarchical k-means over descriptors, k-majority for
/// binary ones. A word is a leaf. Trained once, then it never changes.
class VocabularyTree {
 public:
  /// Called after each level with the share of the work done, in [0, 1]; may throw to stop the training.
  using Progress = std::function<void(double)>;

  /// Trains on the descriptors of all images together; kFloat and kInt8 ones may be mixed, the tree is then
  /// kInt8. The result depends on parameters and descriptors only.
  /// @throws base::Error on descriptors that differ in kind or dimension, and when there are none.
  /// @throws base::ConfigError when a parameter is out of range.
  static VocabularyTree train(std::span<const types::Descriptors* const> images, const TreeParams& params,
                              const Progress& progress = {});
  /// The descriptors that train() would draw from these images, as a copy. Training on it gives the same
  /// tree, at leisure in another thread. Throws as train() does.
  static types::Descriptors sample(std::span<const types::Descriptors* const> images,
                                   const TreeParams& params);

  /// The word of each descriptor: the nearest leaf of those below the `beam` nearest nodes of each level
  /// (ties: the lower number). kFloat descriptors are quantised for a kInt8 tree. Nistér & Stewénius go down
  /// one path; two views of a feature then part more often.
  /// @throws base::Error when they are of another kind or dimension. No descriptors, no words.
  std::vector<base::WordId> wordsOf(const types::Descriptors& descriptors) const;

  std::size_t words() const { return words_; }  ///< their ids are 0 … words() - 1
  types::DescriptorKind kind() const { return centres_.kind(); }
  int dim() const { return centres_.dim(); }
  const TreeParams& params() const { return params_; }  ///< that it was trained with
  std::size_t bytes() const;                            ///< memory

  /// All of it as bytes with magic, version and checksum.
  std::vector<std::uint8_t> serialised() const;
  /// @throws base::Error on any damage and on a newer version.
  static VocabularyTree parse(std::span<const std::uint8_t> bytes);

  /// The same as a file. Throw base::Error that names it; save() when it exists and is not to be overwritten.
  void save(const std::string& path, bool overwrite = false) const;
  static VocabularyTree load(const std::string& path);

  bool operator==(const VocabularyTree&) const = default;

 private:
  friend class TreeTrainer;
  VocabularyTree() = default;
  struct Node {
    std::uint32_t first = 0;     // first child, or the word of a leaf
    std::uint16_t children = 0;  // none: a leaf
    bool operator==(const Node&) const = default;
  };

  struct Search;
  std::uint32_t leafOf(const std::byte* descriptor, Search& search) const;

  TreeParams params_;
  std::vector<Node> nodes_;     // level by level, the root first
  types::Descriptors centres_;  // row i - 1 of node i
  std::uint32_t words_ = 0;
};

}  // namespace engram::vocabulary
