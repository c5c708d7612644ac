// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/memory/fsh.h"
#include "engram/memory/place_memory.h"

#include <memory>
#include <string>

namespace engram::memory {

/// The baseline: the first view of a place, all of it long-term, for ever.
class Static : public MemoryModel {
 public:
  PlaceMemory start(const types::Features& view) const override;
  /// Changes nothing. Checks its arguments as Fsh does.
  types::MemoryChange update(PlaceMemory& memory, const types::Features& view,
                             std::span<const types::Match> matches) const override;
};

/// Section `[memory]`.
struct MemoryParams {
  std::string memory = "fsh";  ///< name of the model (X-02)

  void describe(base::Params& p);
};

/// Throws base::ConfigError that names the key, for an unknown model or parameters that cannot be used.
std::unique_ptr<MemoryModel> makeMemoryModel(const MemoryParams& params, const FshParams& fsh);

}  // namespace engram::memory
