// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/rng.h"
#include "engram/vocabulary/vocabulary_tree.h"

#include <cstdint>
#include <vector>

namespace engram::vocabulary {

/// Grows a VocabularyTree level by level.
class TreeTrainer {
 public:
  TreeTrainer(types::Descriptors samples, const TreeParams& params);
  VocabularyTree train(const VocabularyTree::Progress& progress);

 private:
  using Rows = std::vector<std::uint32_t>;  // of samples_

  std::vector<Rows> grow(std::uint32_t node, const Rows& rows);

  VocabularyTree tree_;
  types::Descriptors samples_;
  base::Rng rng_;
};

}  // namespace engram::vocabulary
