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
# Each library that the extension needs is in the wheel, or is one that every Linux has (PEP 600).
extension="$(echo "$scratch"/venv/lib/python3*/site-packages/mindahl/_mindahl*.so)"
outside="$(env -u LD_LIBRARY_PATH ldd "$extension" | awk '/=>/ {print $1, $3}' | grep -v " $scratch/" |
  grep -Ev '^(linux-vdso|ld-linux[^ ]*|lib(c|m|dl|rt|pthread|util|gcc_s|stdc\+\+))\.so' || true)"
if [ -n "$outside" ] || ! ls "${extension%/*}"/libs/libglog* >/dev/null; then
  echo "wheel: needs libraries that are not in it: $outside" >&2
  exit 1
fi
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
