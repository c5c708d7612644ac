// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// Tables of text: truth in all its forms, TUM, and the list of an image folder.
#include "engram/evaluation/trajectory.h"
#include "engram/evaluation/truth.h"
#include "engram/sources/image_folder_source.h"
#include "fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace engram;
  static const fuzz::InputFile file(".csv");
  const std::string path = file.holding({data, size});
  fuzz::mayRefuse([&] { evaluation::Truth::parse(fuzz::text({data, size}), "truth.csv", {.margin = 1}); });
  fuzz::mayRefuse([&] { evaluation::readPoses(path); });
  fuzz::mayRefuse([&] {
    const auto images = sources::openImageFolder(file.folder(), path);
    while (images->next()) {
    }
  });
  return 0;
}
