// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// A rawlog, gzip or not, as a file.
#include "engram/sources/rawlog_source.h"
#include "fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace engram;
  static const fuzz::InputFile file(".rawlog");
  fuzz::mayRefuse([&] {
    const auto source = sources::openRawlog(file.holding({data, size}));
    while (source->next()) {
    }
    source->problem();
  });
  return 0;
}
