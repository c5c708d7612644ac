#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# fuzz.sh SECONDS [TARGET …]: runs each fuzz target (rawlog, ini, …) so long under ASan and UBSan. Prints executions
# and findings, keeps what crashed in build/fuzz/findings and what it learnt in build/fuzz/corpus. Exit code 1 when
# there are findings.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/setup.sh

[ $# -ge 1 ] || { echo "usage: $0 SECONDS [TARGET …]" >&2; exit 2; }
seconds=$1
shift
ENGRAM_PACKAGES+=(clang libclang-rt-14-dev)
engram_install_packages
if [ $# -gt 0 ]; then engram_build fuzz "${@/%/_fuzz}"; else engram_build fuzz engram_fuzz_targets; fi
[ $# -gt 0 ] || set -- $(cd build/fuzz/tests/fuzz && ls | sed -n 's/_fuzz$//p')

mkdir -p build/fuzz/findings
total=0
for target in "$@"; do
  mkdir -p "build/fuzz/corpus/$target"
  log=build/fuzz/findings/$target.log
  # It goes on after a finding, so that one does not hide the others.
  build/fuzz/tests/fuzz/"${target}_fuzz" "build/fuzz/corpus/$target" "tests/fuzz/corpus/$target" \
    -fork=1 -ignore_crashes=1 -ignore_ooms=1 -ignore_timeouts=1 -max_total_time="$seconds" -timeout=10 \
    -rss_limit_mb=2048 -artifact_prefix="build/fuzz/findings/$target-" >"$log" 2>&1 || true
  executions=$(sed -n 's/^#\([0-9]*\): cov.*/\1/p' "$log" | tail -1)
  findings=$(find build/fuzz/findings -name "$target-*" | wc -l)
  echo "$target: ${executions:-0} executions, $findings findings"
  total=$((total + findings))
done
[ "$total" -eq 0 ]
