#!/usr/bin/env bash
# Installs what building, testing and plotting need, from Debian's packages; quick when all is there.
#   install-dependencies.sh --checks    also what CI checks the source and the pages with
#   install-dependencies.sh --peers     also the programs that bench/peers and tests/convert compare with
#   install-dependencies.sh --workflow  also the engine that workflow/ is for
set -euo pipefail

packages=(
  g++ cmake ninja-build
  libeigen3-dev libfmt-dev libcli11-dev nlohmann-json3-dev libcsv-dev libboost-dev libssl-dev
  libgtest-dev libgmock-dev libbenchmark-dev gnuplot-nox jq python3
)
for group in "$@"; do
  case $group in
    --checks) packages+=(clang-format clang-tidy-19 chromium) ;;  # chromium: 290 MB installed
    --peers) packages+=(python3-lmfit python3-pandas lammps) ;;
    --workflow) packages+=(snakemake) ;;
    *)
      echo "install-dependencies: there is no group '$group': --checks, --peers or --workflow" >&2
      exit 2
      ;;
  esac
done

missing=()
for package in "${packages[@]}"; do
  if ! dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed; then
    missing+=("$package")
  fi
done
if [ ${#missing[@]} -eq 0 ]; then exit 0; fi

if ! command -v apt-get >/dev/null; then
  echo "install-dependencies: apt-get not found; install by hand: ${missing[*]}" >&2
  exit 1
fi
sudo=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "install-dependencies: not root and no sudo; as root: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  sudo=(sudo)
fi
echo "installing ${missing[*]}"
"${sudo[@]}" apt-get update -q
"${sudo[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -q --no-install-recommends "${missing[@]}"
