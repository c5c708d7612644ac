// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cpu.h"

namespace engram::features {

SimdLevel supportedSimd() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                      (__builtin_cpu_supports("avx512vnni") || __builtin_cpu_supports("avx512vpopcntdq"));
    return wide ? SimdLevel::kAvx512 : SimdLevel::kAvx2;
  }
#endif
  return SimdLevel::kPortable;
}

const char* toString(SimdLevel level) {
  switch (level) {
    case SimdLevel::kPortable:
      return "portable";
    case SimdLevel::kAvx2:
      return "avx2";
    case SimdLevel::kAvx512:
      return "avx512";
  }
  return "?";
}

}  // namespace engram::features
