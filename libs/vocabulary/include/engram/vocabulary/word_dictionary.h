// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/ids.h"
#include "engram/base/params.h"
#include "engram/types/features.h"

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace engram::vocabulary {

/// Section `[words]`: the incremental dictionary of A-02.
struct WordParams {
  /// Largest distance of a feature to its word (A-E14): L2 of unit vectors, for float descriptors.
  double max_distance = 0.3;
  /// The same as share of differing bits, for binary descriptors.
  double max_bits = 0.15;
  int checks = 2048;   ///< descriptors a feature is compared with, about; 0 compares with all words
  int leaf_size = 64;  ///< words of one leaf of the search tree
  int branching = 64;  ///< children of one inner node

  void describe(base::Params& p);
  bool operator==(const WordParams&) const = default;
};

/// The word of a feature; invalid when no word is near enough.
struct WordMatch {
  base::WordId word;
  float distance = 0;  ///< as types::Match::distance; to the nearest word seen, even when that is too far
  bool found() const { return word.valid(); }
  bool operator==(const WordMatch&) const = default;
};

/// A dictionary of visual words that starts empty and grows by what it does not know. A word is the
/// descriptor of the feature that founded it. The first descriptors fix kind and dimension; kFloat ones are
/// quantised when the dictionary holds kInt8.
///
/// Words are kept in a height-balanced tree of clusters, a K-tree (Geva 2000): leaves hold words, inner nodes
/// the means of their children (majority bits of binary ones), and a full node is split in two by 2-means.
/// Search goes down with a beam of the nearest nodes of each level and then through the nearest leaves, until
/// `checks` words have been compared: the cost of a lookup grows with the logarithm of the size, and the
/// nearest word is found almost always rather than always. All steps are deterministic.
class WordDictionary {
 public:
  /// @throws base::ConfigError when a parameter is out of range.
  explicit WordDictionary(const WordParams& params);

  /// The word of each descriptor, from what is known now. The result does not depend on `threads`.
  /// @throws base::Error when the descriptors are of another kind or dimension than the words.
  std::vector<WordMatch> lookup(const types::Descriptors& descriptors, int threads = 1) const;

  /// Makes words of the descriptors that `found`, the result of lookup(), gives none. One near a word made
  /// in this very call takes that. Gives the word of every descriptor.
  /// @throws std::invalid_argument when `found` has another length or names a word removed since.
  std::vector<base::WordId> learn(const types::Descriptors& descriptors, std::span<const WordMatch> found);

  /// Its id is never used again. @throws std::invalid_argument when there is no such word.
  void remove(base::WordId word);

  bool contains(base::WordId word) const { return leafOf_.contains(word); }
  std::size_t size() const { return leafOf_.size(); }
  std::uint32_t nextId() const { return nextId_; }
  const WordParams& params() const { return params_; }
  types::DescriptorKind kind() const { return kind_; }
  int dim() const { return dim_; }  ///< 0 before the first descriptors

 private:
  friend class WordIndexCodec;
  static constexpr std::uint32_t kNone = base::WordId::kInvalid;
  struct Node {
    std::uint32_t parent = kNone;
    bool leaf = true;
    std::vector<std::uint32_t> ids;  // words of a leaf, children of an inner node
    types::Descriptors rows;         // parallel: words, means of the children
  };
  struct Branch {
    float distance = 0;
    std::uint32_t order = 0;  // breaks ties; numbers of nodes must not matter, for a file forgets them
    std::uint32_t node = kNone;
    auto operator<=>(const Branch&) const = default;
  };
  struct Search {  // memory of one search, kept for the next
    std::vector<Branch> beam, next;
    std::vector<float> distances;
  };

  types::Descriptors converted(const types::Descriptors& descriptors) const;
  float scaled(float raw) const;
  bool isNear(float distance) const;
  void nearestLeaves(const std::byte* query, std::size_t most, Search& search) const;
  WordMatch nearest(const std::byte* query, Search& search) const;
  void insert(std::uint32_t word, std::span<const std::byte> row);
  void split(std::uint32_t node);
  void adopt(std::uint32_t node);
  void detach(std::uint32_t node);
  std::uint32_t newNode(bool leaf);

  WordParams params_;
  types::DescriptorKind kind_ = types::DescriptorKind::kFloat;
  int dim_ = 0;
  std::uint32_t nextId_ = 0;
  std::uint32_t root_ = kNone;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> freeNodes_;
  std::unordered_map<base::WordId, std::uint32_t> leafOf_;
};

}  // namespace engram::vocabulary
