// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bytes.h"
#include "engram/vocabulary/word_index.h"

#include <array>
#include <limits>

namespace engram::vocabulary {
namespace {

constexpr std::array<std::uint8_t, 7> kWordsMagic{'E', 'G', 'W', 'O', 'R', 'D', 'S'};
constexpr std::uint8_t kWordsVersion = 1;
constexpr std::uint64_t kMostIds = base::WordId::kInvalid;  // ids are below
constexpr int kMostLevels = 64;  // a node has at least two children when it is made, and 2^32 words at most

void putParams(ByteWriter& out, const WordParams& p) {
  out.put(p.max_distance);
  out.put(p.max_bits);
  for (const int v : {p.checks, p.leaf_size, p.branching}) out.varint(static_cast<std::uint64_t>(v));
}

WordParams getParams(ByteReader& in) {
  WordParams p;
  p.max_distance = in.get<double>();
  p.max_bits = in.get<double>();
  for (int* v : {&p.checks, &p.leaf_size, &p.branching})
    *v = static_cast<int>(in.varint(std::numeric_limits<int>::max()));
  return p;
}

}  // namespace

/// The bytes of a WordIndex. Version 1: magic, version; parameters; kind, dimension and next number of the
/// words; the nodes of the tree, level by level; the views by rising number with their words; CRC-32. The
/// numbers of nodes and all that follows from the views are made anew.
class WordIndexCodec {
 public:
  static void put(ByteWriter& out, const WordDictionary& d);
  static void put(ByteWriter& out, const InvertedIndex& index);
  static WordDictionary getDictionary(ByteReader& in);
  static void getIndex(ByteReader& in, WordIndex& words);

 private:
  static void getNode(ByteReader& in, WordDictionary& d, std::uint32_t n);
  static void getLevels(ByteReader& in, WordDictionary& d);
  static InvertedIndex::View getView(ByteReader& in, const WordDictionary& d);
};

void WordIndexCodec::put(ByteWriter& out, const WordDictionary& d) {
  putParams(out, d.params_);
  out.put(static_cast<std::uint8_t>(d.kind_));
  out.varint(static_cast<std::uint64_t>(d.dim_));
  out.varint(d.nextId_);
  std::vector<std::uint32_t> order;
  if (d.root_ != WordDictionary::kNone) order.push_back(d.root_);
  out.put(static_cast<std::uint8_t>(order.size()));
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto& node = d.nodes_[order[k]];
    out.put(static_cast<std::uint8_t>(node.leaf));
    out.varint(node.ids.size());
    for (const std::uint32_t id : node.ids) {
      if (node.leaf)
        out.varint(id);
      else
        order.push_back(id);
    }
    out.raw(node.rows.bytes().data(), node.rows.bytes().size());
  }
}

void WordIndexCodec::getNode(ByteReader& in, WordDictionary& d, std::uint32_t n) {
  const auto leaf = in.get<std::uint8_t>();
  require(leaf <= 1, "a node of its tree is of an unknown kind");
  types::Descriptors rows(d.kind_, d.dim_);
  const std::size_t count = in.count(rows.rowBytes());
  const int capacity = leaf ? d.params_.leaf_size : d.params_.branching;
  require(count >= 1 && count <= static_cast<std::size_t>(capacity),
          "a node of its tree is empty or too full");
  std::vector<std::uint32_t> ids(count);
  for (std::uint32_t& id : ids) {
    if (leaf) {
      require(d.nextId_ > 0, "a word has a false number");
      id = static_cast<std::uint32_t>(in.varint(d.nextId_ - 1));
      require(d.leafOf_.emplace(id, n).second, "a word is there twice");
    } else {
      id = static_cast<std::uint32_t>(d.nodes_.size());  // the next one not yet announced
      d.nodes_.emplace_back().parent = n;
    }
  }
  rows.resize(count);
  in.raw(rows.mutableRow(0), count * rows.rowBytes());
  requireFinite(rows);
  auto& node = d.nodes_[n];
  node.leaf = leaf != 0;
  node.ids = std::move(ids);
  node.rows = std::move(rows);
}

/// A search goes down level by level: all nodes of one are leaves, or none.
void WordIndexCodec::getLevels(ByteReader& in, WordDictionary& d) {
  std::size_t first = 0;
  for (int level = 0; first < d.nodes_.size(); ++level) {
    require(level < kMostLevels, "its tree is too deep");
    const std::size_t end = d.nodes_.size();
    in.require((end - first) * (2 + types::Descriptors(d.kind_, d.dim_).rowBytes()));
    for (std::size_t n = first; n < end; ++n) {
      getNode(in, d, static_cast<std::uint32_t>(n));
      require(d.nodes_[n].leaf == d.nodes_[first].leaf, "its tree is not balanced");
    }
    first = end;
  }
}

WordDictionary WordIndexCodec::getDictionary(ByteReader& in) {
  WordDictionary d(getParams(in));
  const auto kind = in.get<std::uint8_t>();
  require(kind <= static_cast<std::uint8_t>(types::DescriptorKind::kBinary),
          "its descriptors are of an unknown kind");
  d.kind_ = static_cast<types::DescriptorKind>(kind);
  d.dim_ = static_cast<int>(in.varint(kMostDim));
  d.nextId_ = static_cast<std::uint32_t>(in.varint(kMostIds));
  const auto roots = in.get<std::uint8_t>();
  require(roots <= 1 && (roots == 0 || d.dim_ > 0), "its tree is damaged");
  if (roots == 0) return d;
  d.root_ = 0;
  d.nodes_.emplace_back();
  getLevels(in, d);
  return d;
}

void WordIndexCodec::put(ByteWriter& out, const InvertedIndex& index) {
  out.varint(index.views_.size());
  std::uint32_t nextView = 0;
  for (const auto& [id, view] : index.views_) {
    out.varint(id.value - nextView);
    nextView = id.value + 1;
    out.varint(view.place.value);
    out.varint(view.words.size());
    std::uint32_t nextWord = 0;
    for (const auto& [word, count] : view.words) {
      out.varint(word.value - nextWord);
      out.varint(count);
      nextWord = word.value + 1;
    }
  }
}

InvertedIndex::View WordIndexCodec::getView(ByteReader& in, const WordDictionary& d) {
  InvertedIndex::View view;
  view.place = base::PlaceId(static_cast<std::uint32_t>(in.varint(kMostIds - 1)));
  view.words.resize(in.count(2));
  std::uint64_t next = 0;
  for (auto& [word, count] : view.words) {
    next += in.varint(kMostIds);
    require(next < kMostIds, "a word has a false number");
    word = base::WordId(static_cast<std::uint32_t>(next++));
    require(d.contains(word), "a view has a word that is not in the dictionary");
    count = static_cast<std::uint32_t>(in.varint(std::numeric_limits<std::uint32_t>::max()));
    require(count > 0, "a view has a word no time");
  }
  return view;
}

void WordIndexCodec::getIndex(ByteReader& in, WordIndex& words) {
  const std::size_t views = in.count(3);
  std::uint64_t next = 0, features = 0;
  for (std::size_t k = 0; k < views; ++k) {
    next += in.varint(kMostIds);
    require(next < kMostIds, "a view has a false number");
    auto view = getView(in, words.dictionary_);
    for (const auto& w : view.words) features += w.count;
    require(features <= std::numeric_limits<std::uint32_t>::max(), "a view has a word too often");
    words.index_.insert(base::ViewId(static_cast<std::uint32_t>(next++)), std::move(view));
  }
  require(words.index_.words() == words.dictionary_.size(), "a word belongs to no view");
}

std::vector<std::uint8_t> WordIndex::serialised() const {
  ByteWriter out;
  out.raw(kWordsMagic.data(), kWordsMagic.size());
  out.put(kWordsVersion);
  WordIndexCodec::put(out, dictionary_);
  WordIndexCodec::put(out, index_);
  return std::move(out).seal();
}

WordIndex WordIndex::parse(std::span<const std::uint8_t> bytes) {
  try {
    ByteReader in(bytes);
    std::array<std::uint8_t, kWordsMagic.size()> magic{};
    in.raw(magic.data(), magic.size());
    require(magic == kWordsMagic, "it is something else");
    require(in.get<std::uint8_t>() == kWordsVersion, "it was written by a newer version of Engram");
    WordIndex words({});
    words.dictionary_ = WordIndexCodec::getDictionary(in);
    WordIndexCodec::getIndex(in, words);
    in.requireEnd();
    return words;
  } catch (const base::Error& e) {
    throw base::Error("the word index cannot be read: " + std::string(e.what()) +
                      "; recover the map or build it again");
  }
}

}  // namespace engram::vocabulary
