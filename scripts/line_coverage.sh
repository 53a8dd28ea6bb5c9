#!/usr/bin/env bash
# Prints which lines and branches of src and include the tests run, by gcovr: a row a file with the
# lines that no test runs, the least covered files last.
#   scripts/line_coverage.sh [FOLDER]...     of the tests of these folders of tests/; default: all that
#                                            are not slow, with the program
# The page of every line is build/line-coverage/lines.html. Compiled with -O1: without optimisation
# Eigen's expressions make the tests of identification take hours. Lines that the compiler merges
# into others then count with those.
set -euo pipefail
cd "$(dirname "$0")/.."

./scripts/install-dependencies.sh --tests --coverage
build=build/line-coverage
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DMINDAHL_BUILD_TESTS=ON \
  -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=12 \
  -DCMAKE_CXX_FLAGS_DEBUG="-O1 -g1 --coverage -fprofile-abs-path -fprofile-update=atomic" >/dev/null
find "$build" -name '*.gcda' -delete
if (($#)); then
  cmake --build "$build" --target "${@/%/_test}"
  for folder in "$@"; do "$build/tests/${folder}_test" --gtest_brief=1; done
else
  cmake --build "$build"
  # Times are no property of a test, and a test that fails is for CI to say.
  ctest --test-dir "$build" --label-exclude slow --parallel "$(nproc)" || true
fi
gcovr --root . --object-directory "$build" --filter src/ --filter include/ \
  --exclude-throw-branches --exclude-unreachable-branches --sort-percentage \
  --html-details "$build/lines.html" --txt --print-summary
