#!/usr/bin/env bash
# Makes the Debian packages, installs them on a clean root and uses them there: the program on a
# record, its manual pages, the examples against the library by pkg-config
# and by CMake, and the Python module. Needs root and Debian's mirror; leaves build/package/packages.
set -euo pipefail
cd "$(dirname "$0")/.."

./scripts/install-dependencies.sh --packages
cmake --preset package >/dev/null
cmake --build --preset package
packages=$PWD/build/package/packages
rm -rf "$packages"
(cd build/package && cpack -G DEB >/dev/null)
ls -l "$packages"/*.deb

# Debian's own packages have a maintainer with an address and a changelog in Debian's form.
lintian --allow-root --fail-on error,warning \
  --suppress-tags bogus-mail-host,syntax-error-in-debian-changelog "$packages"/*.deb

on_root=$(mktemp)
trap 'rm -f "$on_root"' EXIT
cat >"$on_root" <<'END'
set -eux
cd /tmp/packages
export DEBIAN_FRONTEND=noninteractive
install() { apt-get install -y -q --no-install-recommends "$@" >/dev/null; }

# The program alone, with what its package asks for.
install ./mindahl_*.deb
mindahl simulate --sigma 4e7 --slip-force 40 --lambda 1.2 --cycles 2 --noise-force 0.1 -o loop.csv
mindahl fit loop.csv --json fit.json | head -20
grep -q '"schema": "mindahl.fit/2"' fit.json
install man-db
man mindahl-fit | grep -q 'normal-load'

# The library, without what only building it needs.
install g++ pkg-config ./libmindahl-dev_*.deb
for example in fit_arrays own_term cycles_of_stream fit_to_json; do
  g++ -std=c++20 -O1 "examples/$example.cc" -o "$example" \
    $(pkg-config --cflags --libs --static mindahl)
done
./fit_arrays
./own_term
./cycles_of_stream
./fit_to_json loop.csv >library.json
grep -q '"schema": "mindahl.fit/2"' library.json
test -s /usr/share/mindahl/schema/fit.json
install cmake make
cmake -S examples -B examples_of_cmake >/dev/null
cmake --build examples_of_cmake >/dev/null
./examples_of_cmake/fit_arrays
./examples_of_cmake/mass_on_contact

install ./python3-mindahl_*.deb
python3 -c '
import json, mindahl
fitted = mindahl.fit("loop.csv")
assert fitted.to_dict()["parameters"] == json.load(open("fit.json"))["parameters"]
print(mindahl.__version__, repr(fitted))'
apt-get remove -y -q mindahl >/dev/null
test ! -e /usr/bin/mindahl
END

mmdebstrap --quiet --variant=apt --format=null \
  --customize-hook='mkdir -p "$1/tmp/packages"' \
  --customize-hook="copy-in $(printf '%s ' "$packages"/*.deb) $PWD/examples /tmp/packages" \
  --customize-hook="upload $on_root /tmp/packages/use.sh" \
  --customize-hook='chroot "$1" sh /tmp/packages/use.sh' \
  bookworm /dev/null
echo "the packages install, run and compile on a clean root"
