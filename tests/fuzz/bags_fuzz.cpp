// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// Bags of ROS 1 and 2: every message, and the frames of the topics that the corpus has.
#include "engram/bags/bag_source.h"
#include "fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace engram;
  static const fuzz::InputFile file(".bag");
  const std::string path = file.holding({data, size});
  bags::BagSourceParams params;
  params.image = "/stereo/left/image_raw";
  params.right = "/stereo/right/image_raw";
  for (const auto& each : {params, bags::BagSourceParams{}})
    fuzz::mayRefuse([&] {
      const auto source = bags::openBagSource(path, each);
      while (source->next()) continue;
    });
  return 0;
}
