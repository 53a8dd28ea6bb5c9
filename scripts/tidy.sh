#!/usr/bin/env bash
# clang-tidy with the checks of .clang-tidy over src/, or over the files named; a finding is an error.
#   scripts/tidy.sh [--thorough] [FILE...]
# The files of a module are looked at as one, so that what they all include is parsed once: each
# finding has its own file's place. Files that are named, and all with --thorough, are looked at one
# by one: that finds too which `using` declarations and aliases are unused, looked for in no joined
# file, and what takes much of the time where files are joined and is seldom to be found.
# --thorough adds clang's static analyzer.
# Debian's default, 14, does not parse the sources: no aggregates by deduction, no captured bindings.
set -euo pipefail
cd "$(dirname "$0")/.."

checks=()
join=ON
if [[ ${1:-} == --thorough ]]; then
  checks=(--checks='clang-analyzer-*')
  join=OFF
  shift
fi
if (($#)); then join=OFF; fi
build=build/tidy
if [[ $join == ON ]]; then
  build=build/tidy-joined
  seldom=(performance-unnecessary-value-param misc-unused-using-decls misc-unused-alias-decls
    bugprone-standalone-empty bugprone-stringview-nullptr bugprone-undelegated-constructor
    bugprone-suspicious-string-compare bugprone-reserved-identifier modernize-use-nullptr
    bugprone-multiple-statement-macro bugprone-assert-side-effect)
  checks=(--checks="$(printf ',-%s' "${seldom[@]}" | cut -c2-)")
fi
# Tests are left out, and with them headers precompiled for another compiler.
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_EXPORT_COMPILE_COMMANDS=ON \
  -DMINDAHL_BUILD_TESTS=OFF -DMINDAHL_BUILD_EXAMPLES=OFF \
  -DCMAKE_UNITY_BUILD="$join" -DCMAKE_UNITY_BUILD_BATCH_SIZE=0 >/dev/null

# The sources of the repository that a compiled file consists of: those that it joins, or itself.
sources_of() {
  if [[ $1 == */Unity/* ]]; then
    sed -n 's/^#include "\(.*\)"$/\1/p' "$1"
  else
    echo "$1"
  fi
}

if (($#)); then
  files=("$@")
elif [[ $join == OFF ]]; then
  mapfile -t files < <(git ls-files 'src/*.cc')
else
  mapfile -t files < <(sed -n 's/^ *"file": "\(.*\)",\?$/\1/p' "$build/compile_commands.json")
  missed=$(comm -23 <(git ls-files 'src/*.cc' | sort) \
    <(for file in "${files[@]}"; do sources_of "$file"; done | sed "s|^$PWD/||" | sort))
  if [[ $missed ]]; then
    echo "tidy: in no target of src/CMakeLists.txt: ${missed//$'\n'/ }" >&2
    exit 1
  fi
fi

# The longest first, so that no core is left with them at the end.
for file in "${files[@]}"; do
  echo "$(sources_of "$file" | xargs cat | wc -l) $file"
done | sort -rn | cut -d' ' -f2- |
  xargs -P "$(nproc)" -n 1 clang-tidy-19 -p "$build" --quiet "${checks[@]}"
