// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// A vocabulary tree or a word index. The checksum is made right here: it guards against accidents, not
// against people.
#include "engram/vocabulary/vocabulary_tree.h"
#include "engram/vocabulary/word_index.h"
#include "fuzz_input.h"

#include <cstring>
#include <vector>
#include <zlib.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace engram;
  std::vector<std::uint8_t> sealed(data, data + size);
  const auto crc = static_cast<std::uint32_t>(crc32_z(0, data, size));
  sealed.resize(size + sizeof crc);
  std::memcpy(sealed.data() + size, &crc, sizeof crc);
  fuzz::mayRefuse([&] { vocabulary::VocabularyTree::parse(sealed); });
  fuzz::mayRefuse([&] { vocabulary::WordIndex::parse(sealed); });
  return 0;
}
