#!/usr/bin/env bash
# clang-tidy with the checks of .clang-tidy over src/, or over the files named; a finding is an error.
#   scripts/tidy.sh [--thorough] [FILE...]
# --thorough adds clang's static analyzer. MINDAHL_BUILD names a configured build (build/tidy).
# Debian's default, 14, does not parse the sources: no aggregates by deduction, no captured bindings.
set -euo pipefail
cd "$(dirname "$0")/.."

checks=()
if [[ ${1:-} == --thorough ]]; then
  checks=(--checks='clang-analyzer-*')
  shift
fi
build="${MINDAHL_BUILD:-build/tidy}"
if [[ ! -f $build/compile_commands.json ]]; then
  # Tests are left out, and with them headers precompiled for another compiler.
  cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_EXPORT_COMPILE_COMMANDS=ON \
    -DMINDAHL_BUILD_TESTS=OFF -DMINDAHL_BUILD_EXAMPLES=OFF >/dev/null
fi
if (($#)); then files=("$@"); else mapfile -t files < <(git ls-files 'src/*.cc'); fi

# The longest first, so that no core is left with them at the end.
wc -l "${files[@]}" | sort -rn | awk '$2 != "total" {print $2}' |
  xargs -P "$(nproc)" -n 1 clang-tidy-19 -p "$build" --quiet "${checks[@]}"
