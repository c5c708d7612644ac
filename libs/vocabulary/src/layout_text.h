// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/features.h"

#include <string>

namespace engram::vocabulary {

/// "64 bytes", "256 bits": for messages.
inline std::string layoutText(types::DescriptorKind kind, int dim) {
  using types::DescriptorKind;
  return std::to_string(dim) + (kind == DescriptorKind::kBinary ? " bits"
                                : kind == DescriptorKind::kInt8 ? " bytes"
                                                                : " floats");
}
inline std::string layoutText(const types::Descriptors& d) { return layoutText(d.kind(), d.dim()); }

}  // namespace engram::vocabulary
