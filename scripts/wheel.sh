#!/usr/bin/env bash
# Makes a Python wheel without a network, of the package that a build tree holds:
#   scripts/wheel.sh [directory for the wheel [build tree]]     default: build/wheel, of build/ci
set -euo pipefail
cd "$(dirname "$0")/.."

output="${1:-build/wheel}"
package="$(realpath "${2:-build/ci}")/python/package"
python="${MINDAHL_PYTHON:-/usr/bin/python3}"
if ! compgen -G "$package/mindahl/_mindahl*.so" >/dev/null; then
  echo "wheel: no extension in $package: cmake --build with MINDAHL_BUILD_PYTHON=ON first" >&2
  exit 2
fi
mkdir -p "$output"
# setuptools writes beside its sources: into a copy.
sources="$(mktemp -d)"
trap 'rm -rf "$sources"' EXIT
cp -R CMakeLists.txt pyproject.toml setup.py README.md LICENSE python "$sources"
MINDAHL_PYTHON_BUILD_DIR="$package" "$python" -m pip wheel --quiet --no-index --no-deps \
  --no-build-isolation --wheel-dir "$output" "$sources"
ls "$output"/mindahl-*.whl
