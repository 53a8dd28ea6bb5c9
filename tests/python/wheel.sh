#!/usr/bin/env bash
# A wheel made offline installs into an environment of its own, and fits there what the program fits.
#   wheel.sh PYTHON BUILD_DIRECTORY SOURCE_DIRECTORY
set -euo pipefail
python="$1" build="$2" source="$3"
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT

MINDAHL_PYTHON="$python" "$source/scripts/wheel.sh" "$scratch/wheel" "$build"
"$python" -m venv --system-site-packages --without-pip "$scratch/venv"
"$python" -m pip --python "$scratch/venv/bin/python" install --quiet --no-index --no-deps \
  --no-build-isolation "$scratch"/wheel/mindahl-*.whl
cd "$scratch"
env -u PYTHONPATH "$scratch/venv/bin/python" - "$source/data/mindlin_sphere_on_plane.csv" \
  "$build/src/mindahl" "$scratch/venv" <<'SCRIPT'
import json
import subprocess
import sys

import mindahl

record, program, environment = sys.argv[1:]
assert mindahl.__file__.startswith(environment), mindahl.__file__
expected = subprocess.run([program, "fit", record, "--json", "-"], capture_output=True, check=True)
assert mindahl.fit(record).to_dict() == json.loads(expected.stdout)
print("the wheel of mindahl", mindahl.__version__, "fits as the program does")
SCRIPT
