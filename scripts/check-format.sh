#!/usr/bin/env bash
# Fails where a source file is not as clang-format leaves it; `check-format.sh --fix` formats instead.
set -euo pipefail
cd "$(dirname "$0")/.."

mode=(--dry-run --Werror)
if [[ ${1:-} == --fix ]]; then mode=(-i); fi
git ls-files -z '*.cc' '*.h' | xargs -0 clang-format "${mode[@]}"
