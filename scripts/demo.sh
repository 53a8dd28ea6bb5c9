#!/usr/bin/env bash
# Installs what is missing, builds mindahl, fits a loop from data/ and prints the identified contact
# beside the truth from which the loop was made.
set -euo pipefail
cd "$(dirname "$0")/.."

./scripts/install-dependencies.sh
cmake -S . -B build/demo -G Ninja -DCMAKE_BUILD_TYPE=Release -DMINDAHL_BUILD_TESTS=OFF \
  -DMINDAHL_BUILD_EXAMPLES=OFF >/dev/null
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
"$mindahl" fit "$loop" "${contact[@]}" --plot build/demo/loop.png >"$results/fit"
"$mindahl" contact "${contact[@]}" --friction "$friction" >"$results/truth"

echo "Identified from $loop, beside the contact from which it was simulated:"
echo
awk '
  function row(name, unit, value, error, truth) {
    printf "%-24s %-4s %14s %14s %14.6g %10.3f %%\n", name, unit, value, error, truth,
           100 * (value / truth - 1)
  }
  FNR == NR { truth[$1] = $2; next }
  /Hertz and Mindlin predict/ { exit }
  FNR == 1 {
    printf "%-24s %-4s %14s %14s %14s %12s\n", "", "", "identified", "std. error", "truth", "difference"
  }
  $1 == "sigma" || $1 == "alpha" || $1 == "slip_force" { row($1, $2, $3, $4, truth[$1]) }
  /friction coefficient/ { row("friction_coefficient", "-", $3, $5, truth["friction_coefficient"]) }
  /contact radius  / { row("contact_radius", "m", $3, $5, truth["contact_radius"]) }
  /equivalent radius  / { row("equivalent_radius", "m", $3, $5, truth["equivalent_radius"]) }
  /maximum pressure  / { row("maximum_pressure", "Pa", $3, $5, truth["maximum_pressure"]) }
' "$results/truth" "$results/fit"
echo
echo "The loop and the fit: build/demo/loop.png"
