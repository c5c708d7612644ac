#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# docs_test.sh SOURCES BIN: README and docs/ have no dead link, and every command in them names a program, subcommand and
# options that exist. The README stays short.
cd "$1" || exit 1
bin=$2
failed=0
fail() { echo "$*"; failed=1; }

[ "$(wc -l <README.md)" -le 120 ] || fail "README.md: more than 120 lines"

for page in README.md CONTRIBUTING.md docs/*.md; do
  while read -r link; do
    [ -e "$(dirname "$page")/${link%%#*}" ] || fail "$page: dead link $link"
  done < <(grep -oE '\]\([^)]+\)' "$page" | sed 's/^](//; s/)$//' | grep -vE '^(https?:|#)')
done

declare -A helps
while IFS=: read -r page number line; do
  line=${line%% #*}
  read -r program rest <<<"${line#"${line%%[![:space:]]*}"}"
  [ -x "$bin/$program" ] || { fail "$page:$number: no program $program"; continue; }
  command=""
  if "$bin/$program" --help | grep -q '^Subcommands:'; then
    command=${rest%% *}
    "$bin/$program" --help | sed -n '/^Subcommands:/,/^$/p' | grep -q "^  $command " ||
      { [[ $command == --* ]] || fail "$page:$number: $program has no $command"; command=""; }
  fi
  help=${helps["$program $command"]:=$("$bin/$program" $command --help)}
  while read -r option; do
    grep -qE -- "(^|[ ,])$option([ ,:]|$)" <<<"$help" || fail "$page:$number: $program $command has no $option"
  done < <(grep -oE -- '(^| )--[a-z][a-z-]*' <<<"$rest" | tr -d ' ' | sort -u)
done < <(grep -nE '^ {4,}engram-[a-z]+' README.md docs/*.md)
exit $failed
