// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace engram::features {

/// Instruction sets that the kernels come in. All give the same results; they differ in speed only.
enum class SimdLevel { kPortable = 0, kAvx2 = 1, kAvx512 = 2 };

/// The highest level of this machine, found at run time.
SimdLevel supportedSimd();

const char* toString(SimdLevel level);

}  // namespace engram::features
