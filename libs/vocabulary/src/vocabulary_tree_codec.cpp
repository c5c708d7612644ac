// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// A vocabulary tree as bytes and as a file.
#include "bytes.h"
#include "engram/base/atomic_file.h"
#include "engram/vocabulary/vocabulary_tree.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

namespace engram::vocabulary {
namespace {

constexpr std::array<std::uint8_t, 6> kTreeMagic{'E', 'G', 'T', 'R', 'E', 'E'};
constexpr std::uint8_t kTreeVersion = 1;

auto numbersOf(TreeParams& p) {
  return std::array{&p.branching, &p.depth, &p.min_split, &p.max_training, &p.iterations, &p.beam, &p.seed};
}

}  // namespace

/// Version 1: magic, version; the parameters of the training; kind and dimension; the number of children of
/// each node, level by level; the centres in the same order; CRC-32. All other numbers follow.
std::vector<std::uint8_t> VocabularyTree::serialised() const {
  ByteWriter out;
  out.raw(kTreeMagic.data(), kTreeMagic.size());
  out.put(kTreeVersion);
  TreeParams params = params_;
  for (const int* value : numbersOf(params)) out.varint(static_cast<std::uint64_t>(*value));
  out.put(static_cast<std::uint8_t>(kind()));
  out.varint(static_cast<std::uint64_t>(dim()));
  out.varint(nodes_.size());
  for (const Node& node : nodes_) out.put(static_cast<std::uint8_t>(node.children));
  out.raw(centres_.bytes().data(), centres_.bytes().size());
  return std::move(out).seal();
}

VocabularyTree VocabularyTree::parse(std::span<const std::uint8_t> bytes) {
  try {
    ByteReader in(bytes);
    std::array<std::uint8_t, kTreeMagic.size()> magic{};
    in.raw(magic.data(), magic.size());
    require(magic == kTreeMagic, "it is something else");
    require(in.get<std::uint8_t>() == kTreeVersion, "it was written by a newer version of Engram");
    VocabularyTree tree;
    for (int* value : numbersOf(tree.params_))
      *value = static_cast<int>(in.varint(std::numeric_limits<int>::max()));
    base::validate(tree.params_);
    const auto kind = in.get<std::uint8_t>();
    require(kind <= static_cast<std::uint8_t>(types::DescriptorKind::kBinary),
            "its descriptors are of an unknown kind");
    tree.centres_ =
        types::Descriptors(static_cast<types::DescriptorKind>(kind), static_cast<int>(in.varint(kMostDim)));
    require(tree.dim() > 0, "its descriptors have no components");
    const std::size_t nodes = in.count(1);
    require(nodes > 0, "it has no root");
    std::uint64_t next = 1;
    for (std::size_t i = 0; i < nodes; ++i) {
      Node& node = tree.nodes_.emplace_back();
      node.children = in.get<std::uint8_t>();
      node.first = node.children > 0 ? static_cast<std::uint32_t>(next) : tree.words_++;
      next += node.children;
      // The children of a node are behind it.
      require(node.children != 1 && next <= nodes && (next > i + 1 || i + 1 == nodes),
              "its nodes do not fit together");
    }
    require(next == nodes, "its nodes do not fit together");
    const std::size_t size = (nodes - 1) * tree.centres_.rowBytes();
    in.require(size);
    tree.centres_.resize(nodes - 1);
    in.raw(tree.centres_.mutableRow(0), size);
    in.requireEnd();
    requireFinite(tree.centres_);
    return tree;
  } catch (const base::Error& e) {
    throw base::Error("the vocabulary cannot be read: " + std::string(e.what()) + "; train it again");
  }
}

void VocabularyTree::save(const std::string& path, bool overwrite) const {
  const auto bytes = serialised();
  base::writeText(path, std::string(bytes.begin(), bytes.end()), overwrite);
}

VocabularyTree VocabularyTree::load(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || std::filesystem::is_directory(path))
    throw base::Error("vocabulary '" + path + "' cannot be opened: is it there, and may you read it?");
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), {}};
  try {
    return parse(bytes);
  } catch (const base::Error& e) {
    throw base::Error("'" + path + "': " + e.what());
  }
}

}  // namespace engram::vocabulary
