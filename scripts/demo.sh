#!/usr/bin/env bash
# Installs what is missing, builds mindahl, fits a loop from data/ and prints the identified contact
# beside the truth from which the loop was made.
set -euo pipefail
cd "$(dirname "$0")/.."

./scripts/install-dependencies.sh
# Each module as one source, and what parses and prints not optimised: two thirds of the time.
cmake -S . -B build/demo -G Ninja -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS_RELEASE=-O2 -DNDEBUG" \
  -DMINDAHL_COLD_COMPILE_OPTIONS=-O0 -DMINDAHL_BUILD_TESTS=OFF -DMINDAHL_BUILD_EXAMPLES=OFF \
  -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=0 >/dev/null
cmake --build build/demo --target mindahl
mindahl=build/demo/src/mindahl

# A steel ball of 50 mm radius on a steel plane, 50 N: what is known of the contact.
contact=(--normal-load 50
  --youngs-modulus-1 210e9 --poisson-1 0.3 --radius-1 0.05
  --youngs-modulus-2 210e9 --poisson-2 0.3 --radius-2 inf)
friction=0.3  # what is not: data/mindlin_sphere_on_plane.csv was simulated with it
loop=data/mindlin_sphere_on_plane.csv

results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
"$mindahl" fit "$loop" "${contact[@]}" --plot build/demo/loop.png --json "$results/fit.json" >/dev/null
"$mindahl" contact "${contact[@]}" --friction "$friction" --json "$results/truth.json" >/dev/null

echo "Identified from $loop, beside the contact from which it was simulated:"
echo
printf '%-24s %-4s %14s %14s %14s %14s %12s\n' "" "" identified from to truth difference
jq --raw-output --slurp '
  .[0] as $fit | .[1] as $truth
  | (("sigma", "alpha", "slip_force") | ["parameters", .]),
    (("friction_coefficient", "contact_radius", "equivalent_radius", "maximum_pressure")
     | ["contact", .])
  | . as $path
  | ($fit | getpath($path)) as $found
  | ($truth | getpath($path).value) as $true
  | [$path[1], $found.unit, $found.value, $found.ci95[0], $found.ci95[1], $true,
     100 * ($found.value / $true - 1)]
  | @tsv' "$results/fit.json" "$results/truth.json" |
  while IFS=$'\t' read -r name unit value from to truth difference; do
    printf '%-24s %-4s %14.6g %14.6g %14.6g %14.6g %10.3f %%\n' \
      "$name" "$unit" "$value" "$from" "$to" "$truth" "$difference"
  done
echo
echo "The loop and the fit: build/demo/loop.png"
