#!/usr/bin/env bash
# A wheel made offline installs into an environment of its own, and fits there what the program fits.
#   wheel.sh PYTHON BUILD_DIRECTORY SOURCE_DIRECTORY [sdist]      COMPLETE=1: all must be in it
# sdist: what pip builds of a distribution of the sources, instead of the build tree's package.
set -euo pipefail
python="$1" build="$2" source="$3"
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT

"$python" -m venv --system-site-packages --without-pip "$scratch/venv"
pip=("$python" -m pip --python "$scratch/venv/bin/python" install --quiet --no-index --no-deps
  --no-build-isolation)
if [ "${4:-}" = sdist ]; then
  mkdir -p "$scratch/sources/docs"
  cd "$source"
  cp -R CMakeLists.txt LICENSE MANIFEST.in README.md pyproject.toml setup.py cmake include src python \
    "$scratch/sources"
  cp -R docs/schema "$scratch/sources/docs"
  cd "$scratch/sources"
  "$python" setup.py --quiet sdist --dist-dir "$scratch/sdist"
  "${pip[@]}" "$scratch"/sdist/mindahl-*.tar.gz
else
  MINDAHL_PYTHON="$python" "$source/scripts/wheel.sh" "$scratch/wheel" "$build"
  "${pip[@]}" "$scratch"/wheel/mindahl-*.whl
fi
cd "$scratch"
site="$(echo "$scratch"/venv/lib/python3*/site-packages)"
# Either all that a Linux need not have (PEP 600) is in the wheel, or nothing; and nothing of another
# licence than those that ask for their text, which is there.
mapfile -t bundled < <(find "$site/mindahl/libs" -type f -printf '%f\n' 2>/dev/null)
outside="$(env -u LD_LIBRARY_PATH ldd "$site"/mindahl/_mindahl*.so | awk '/=>/ {print $1, $3}' | grep -v " $scratch/" |
  grep -Ev '^(linux-vdso|ld-linux[^ ]*|lib(c|m|dl|rt|pthread|util|gcc_s|stdc\+\+))\.so' || true)"
if ((${#bundled[@]} || ${COMPLETE:-0})) && [ -n "$outside" ]; then
  echo "wheel: needs libraries that are not in it: $outside" >&2
  exit 1
fi
for library in "${bundled[@]}"; do
  if ! [[ $library =~ ^lib(fmt|z|md)\. ]]; then
    echo "wheel: bundles $library" >&2
    exit 1
  fi
done
grep -q "Mozilla Public License" "$site/mindahl/licences/libeigen3-dev.txt"
grep -q "MIT" "$site"/mindahl-*.dist-info/LICENSE
grep -q "^# mindahl" "$site"/mindahl-*.dist-info/METADATA

# The program, as a script and as a module; the package.
export -n PYTHONPATH
record="$source/data/mindlin_sphere_on_plane.csv"
"$build/src/mindahl" fit "$record" --json expected.json >/dev/null
for run in "$scratch/venv/bin/mindahl" "$scratch/venv/bin/python -m mindahl"; do
  $run fit "$record" --json - | cmp - expected.json
  status=0
  $run fit no_such.csv 2>/dev/null || status=$?
  [ "$status" -eq 2 ]
done
"$scratch/venv/bin/python" - "$record" "$scratch" <<'SCRIPT'
import json
import sys

import mindahl

record, scratch = sys.argv[1:]
assert mindahl.__file__.startswith(scratch), mindahl.__file__
with open("expected.json", encoding="utf-8") as file:
    assert mindahl.fit(record).to_dict() == json.load(file)
print("the wheel of mindahl", mindahl.__version__, "fits as the program does")
SCRIPT
