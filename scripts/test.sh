#!/usr/bin/env bash
# Installs what is missing, builds with warnings as errors and runs every test.
#   scripts/test.sh [preset]     preset: ci (default) or asan
set -euo pipefail
cd "$(dirname "$0")/.."

preset="${1:-ci}"
./scripts/install-dependencies.sh
cmake --preset "$preset" >/dev/null
cmake --build --preset "$preset"
ctest --preset "$preset" --output-on-failure --parallel "$(nproc)"
