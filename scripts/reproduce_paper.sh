#!/usr/bin/env bash
# Makes figures 3-8 of the paper with the corrected equations, as CSV and PNG, and checks its
# numbers; fails when one is not found again. docs/paper.md explains the output.
#   scripts/reproduce_paper.sh [DIR]     DIR: build/paper (default)
set -euo pipefail
directory="$(realpath -m "${1:-"$(dirname "$0")/../build/paper"}")"
cd "$(dirname "$0")/.."

./scripts/install-dependencies.sh
cmake -S . -B build/paper-build -G Ninja -DCMAKE_BUILD_TYPE=Release -DMINDAHL_BUILD_TESTS=OFF \
  -DMINDAHL_BUILD_EXAMPLES=OFF -DMINDAHL_BUILD_REFERENCE_TOOLS=ON >/dev/null
cmake --build build/paper-build --target reproduce_paper >&2

build/paper-build/tools/paper/reproduce_paper "$directory"
echo
echo "The figures, as .csv and .png: $directory/paper_fig{3,4,5,6,7,8}"
