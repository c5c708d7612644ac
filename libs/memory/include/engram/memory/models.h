// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/memory/fsh.h"
#include "engram/memory/multi_store.h"
#include "engram/memory/place_memory.h"

#include <memory>
#include <string>

namespace engram::memory {

/// Section `[memory]`.
struct MemoryParams {
  std::string memory = "fsh";  ///< name of the model (X-02)
  /// `per_image`: a place learns from every verified view that is chosen for learning; `per_pass`: at most
  /// once until the robot has been elsewhere (D-E3).
  std::string update_policy = "per_image";
  /// `verified`: while localising a place learns only what geometry has confirmed. `none`: the most
  /// probable place learns each image, as F alg 2 is printed (F-E16).
  std::string gate = "verified";

  void describe(base::Params& p);
};

/// Throws base::ConfigError that names the key, for an unknown model or parameters that cannot be used.
std::unique_ptr<MemoryModel> makeMemoryModel(const MemoryParams& params, const FshParams& fsh,
                                             const MultiStoreParams& multiStore);

}  // namespace engram::memory
