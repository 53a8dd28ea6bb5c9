#!/usr/bin/env bash
# Runs the targets of tests/fuzz with libFuzzer under the address and undefined-behaviour sanitizers and
# prints a row for each: executions, edges of the code that were reached, inputs kept, findings.
#   scripts/fuzz.sh [--seconds N] [TARGET]...     N seconds a target (default 600); default: all targets
# What was learnt stays in build/fuzz/corpus, findings in build/fuzz/findings; one is repeated by
# build/ci/tests/fuzz/fuzz_replay TARGET FILE. An input that ends a run is a test once it is copied to
# tests/fuzz/corpus/TARGET. Ends with 1 where there are findings.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=600
if [[ ${1:-} == --seconds ]]; then
  seconds=$2
  shift 2
fi
targets=("$@")
if ((!$#)); then mapfile -t targets < <(ls tests/fuzz/corpus); fi

./scripts/install-dependencies.sh --fuzz
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target fuzz_targets
findings=build/fuzz/findings
mkdir -p "$findings"
# Of libraries that the sanitizers do not see into.
export ASAN_OPTIONS=detect_odr_violation=0:allocator_may_return_null=1
export UBSAN_OPTIONS=print_stacktrace=1

found=0
printf '%-14s %12s %8s %8s %9s\n' target executions edges kept findings
for target in "${targets[@]}"; do
  learnt=build/fuzz/corpus/$target
  mkdir -p "$learnt"
  log=build/fuzz/$target.log
  length=$(sed -n "s/.*Target{\"$target\", [^,]*, \([0-9]*\)}.*/\1/p" tests/fuzz/target.h)
  status=0
  MINDAHL_FUZZ_TARGET=$target build/fuzz/tests/fuzz/fuzz_targets "$learnt" "tests/fuzz/corpus/$target" \
    -max_total_time="$seconds" -timeout=60 -rss_limit_mb=3000 -max_len="$length" -print_final_stats=1 \
    -artifact_prefix="$findings/$target-" >"$log" 2>&1 || status=$?
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -1)
  count=$(find "$findings" -name "$target-*" | wc -l)
  printf '%-14s %12s %8s %8s %9s\n' "$target" "${executions:-0}" "${edges:-0}" \
    "$(find "$learnt" -type f | wc -l)" "$count"
  if ((status != 0)); then
    found=1
    (grep -m 3 -E 'ERROR|runtime error|fuzz: violated|SUMMARY' "$log" || tail -3 "$log") |
      sed 's/^/    /'
  fi
done
exit $found
