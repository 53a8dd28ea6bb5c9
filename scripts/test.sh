#!/usr/bin/env bash
# Installs what is missing, builds with warnings as errors and runs every test.
#   scripts/test.sh [preset [option of ctest]...]     preset: ci (default), asan or asan-full
set -euo pipefail
cd "$(dirname "$0")/.."

preset="${1:-ci}"
shift $(($# > 0))
./scripts/install-dependencies.sh --tests
cmake --preset "$preset" >/dev/null
cmake --build --preset "$preset"
ctest --preset "$preset" --output-on-failure --parallel "$(nproc)" "$@"
grep -h 'blocks checked' "build/$preset/Testing/Temporary/LastTest.log" || true
