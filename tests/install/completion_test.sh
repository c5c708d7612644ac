# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# completion_test.sh PREFIX: what the installed completion offers.
source "$1/share/bash-completion/completions/engram-slam"
offered() {
  COMP_WORDS=("$@")
  COMP_CWORD=$(($# - 1))
  _engram "$prefix/bin/$1" "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
  echo "${COMPREPLY[*]}"
}
prefix=$1
offered engram-slam fsh_o
offered engram-slam --overwrite-r
offered engram-map inf
offered engram-map info --j
