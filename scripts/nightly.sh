#!/usr/bin/env bash
# What takes too long for .ci/run: every test with those labelled slow, under the sanitizers with all
# their checks too; clang-tidy, and with clang's static analyzer; the intervals' coverage over a
# thousand loops a row; how often a corrupted loop is fitted wrongly without a word; the mapping over
# thousands of contacts with another seed every night; a campaign through Slurm; the Debian packages,
# used on a clean root; a wheel that is complete.
# Some hours on two cores. Every part runs, whatever became of those before.
set -uo pipefail
cd "$(dirname "$0")/.."

failed=()
part() {
  echo "=== $*"
  "$@" || failed+=("$*")
}

./scripts/install-dependencies.sh --checks --packages --peers --readers --clang --workflow || exit
part ./scripts/test.sh ci
part ./scripts/slurm.sh
part ./scripts/test.sh asan-full
part ./scripts/tidy.sh
part ./scripts/tidy.sh --thorough
part ./scripts/clang.sh
part ./scripts/fuzz.sh --seconds 600
part ./scripts/packages.sh
part ./scripts/ceres.sh build/ceres
part env COMPLETE=1 CMAKE_PREFIX_PATH="$PWD/build/ceres" \
  tests/python/wheel.sh /usr/bin/python3 "$PWD/build/ci" "$PWD" sdist
part cmake --build build/ci --target \
  measure_accuracy make_history_table measure_effective measure_minima
part cmake --build build/ci --target coverage
part cmake --build build/ci --target reliability
seed=$(date +%Y%m%d)
part build/ci/src/mindahl validate --cases 5000 --seed "$seed"

if ((${#failed[@]})); then
  printf 'failed: %s\n' "${failed[@]}"
  exit 1
fi
