#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Fails, naming file and line, when a tracked C++ file is not as .clang-format has it.
set -euo pipefail
cd "$(dirname "$0")/.."
git ls-files -z '*.h' '*.cpp' | xargs -0 -n 50 -P "$(nproc)" clang-format --dry-run --Werror ||
  { echo "Not clean: clang-format -i on the files above." >&2; exit 1; }
