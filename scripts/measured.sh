#!/usr/bin/env bash
# Fits the measured records of docs/measured.md and draws the pictures of that page.
#   scripts/measured.sh [DIR]     DIR: build/measured (default)
# The records are other people's and not part of the project: they are looked for in
# MINDAHL_MEASURED_DIR, else in ../shared/measured, and what is absent is skipped with a message.
# MINDAHL names the program, else it is built.
set -euo pipefail
directory="$(realpath -m "${1:-"$(dirname "$0")/../build/measured"}")"
cd "$(dirname "$0")/.."
measured="${MINDAHL_MEASURED_DIR:-../shared/measured}"

if [[ ! -d $measured ]]; then
  echo "skipped: there are no measured records in $measured (set MINDAHL_MEASURED_DIR)"
  exit 0
fi
if [[ -z ${MINDAHL:-} ]]; then
  ./scripts/install-dependencies.sh
  cmake -S . -B build/measured-build -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DMINDAHL_BUILD_TESTS=OFF -DMINDAHL_BUILD_EXAMPLES=OFF >/dev/null
  cmake --build build/measured-build --target mindahl >&2
  MINDAHL=build/measured-build/src/mindahl
fi
mkdir -p "$directory"

# fit NAME FILE OPTION...: NAME.txt has what the program prints, measured_NAME.png its picture.
fit() {
  local name=$1 file=$measured/$2
  shift 2
  if [[ ! -f $file ]]; then
    echo "skipped: $name: there is no $file"
    return
  fi
  local status=0
  "$MINDAHL" fit "$file" "$@" --plot "$directory/measured_$name.png" \
    >"$directory/$name.txt" 2>&1 || status=$?
  # 3: ran, and says that something is not established.
  if ((status != 0 && status != 3)); then
    cat "$directory/$name.txt" >&2
    exit "$status"
  fi
  echo "$name: exit status $status, $directory/$name.txt"
}

tribometer=tribometer/test_data_2.txt
fit tribometer $tribometer --select time=20:60
fit tribometer_rig $tribometer --select time=20:60 --model mindlin --rig-stiffness fit
fit tribometer_load $tribometer --select load=4.98:5.1
fit tribometer_compare $tribometer --select time=20:60 --compare

columns=(--displacement "5 [mm]" --force "7 [N]" --time "1 [ms]")
fit oring seals/O-ring257_3bar.csv "${columns[@]}"
fit nap seals/NAP310_5bar.csv "${columns[@]}"
fit circle seals/Circle_1bar.csv "${columns[@]}"

cycloidal=cycloidal/2024-07-12__16-46-43__torqueramp__conic_4pre1.csv
fit cycloidal $cycloidal
fit cycloidal_4Nm $cycloidal --select time=8.13:12.18
fit cycloidal_40Nm $cycloidal --select time=20.32:40.37

fit band_brake band_brake/dataset-1_0.5Hz70lbtension.csv
