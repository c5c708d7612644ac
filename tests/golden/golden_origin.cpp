// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "golden_origin.h"

#include <Eigen/Core>
#include <ceres/version.h>
#include <opencv2/core.hpp>

#include <gnu/libc-version.h>

namespace engram::testing {
namespace {

/// The instruction sets that our kernels, OpenCV and the C library choose by.
std::string processor() {
#if defined(__x86_64__)
  std::string name = "x86_64";
  if (__builtin_cpu_supports("sse4.2")) name += " sse4.2";
  if (__builtin_cpu_supports("avx2")) name += " avx2";
  if (__builtin_cpu_supports("fma")) name += " fma";
  if (__builtin_cpu_supports("avx512f")) name += " avx512f";
  if (__builtin_cpu_supports("avx512vnni")) name += " avx512vnni";
  return name;
#elif defined(__aarch64__)
  return "aarch64";
#else
  return "unknown processor";
#endif
}

std::string build() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return "sanitised";
#elif defined(__OPTIMIZE__)
  return "optimised";
#else
  return "not optimised";
#endif
}

}  // namespace

std::string goldenOrigin() {
  const std::string eigen = std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) +
                            "." + std::to_string(EIGEN_MINOR_VERSION);
  return processor() + "; compiler " __VERSION__ " " + build() + "; libc " + gnu_get_libc_version() +
         "; OpenCV " CV_VERSION "; Eigen " + eigen + "; Ceres " CERES_VERSION_STRING;
}

}  // namespace engram::testing
