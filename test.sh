#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs what is missing, builds with warnings as errors (the presets say so, for demo.sh too: nothing is compiled
# twice), and runs the whole test suite; with ENGRAM_ASAN=1 also the tests of what reads files of others under ASan
# and UBSan.
set -euo pipefail
cd "$(dirname "$0")"
source scripts/setup.sh

engram_install_packages "${ENGRAM_TEST_PACKAGES[@]}"
engram_build "${ENGRAM_PRESET:-release}"
ctest --preset "${ENGRAM_PRESET:-release}" -j "$(nproc)" "$@"

if [ "${ENGRAM_ASAN:-0}" = 1 ]; then
  ENGRAM_CMAKE_OPTIONS="-DENGRAM_BENCH=OFF ${ENGRAM_CMAKE_OPTIONS:-}" engram_build asan engram_reader_tests
  ctest --preset asan -j "$(nproc)" -L readers
fi
