#!/usr/bin/env bash
# Builds Ceres without SuiteSparse, LAPACK and glog, of the source that Debian has: what mindahl needs of
# it is dense. For wheels that bundle nothing under the GPL (setup.py):
#   scripts/ceres.sh DIRECTORY [job]      then CMAKE_PREFIX_PATH=DIRECTORY pip wheel ...
set -euo pipefail
mkdir -p "$1"
prefix="$(realpath "$1")"
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

# Lists of its own: those of the system need not have sources.
mkdir -p lists/partial
echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://deb.debian.org/debian bookworm main" >sources.list
options=(-o "Dir::Etc::SourceList=$scratch/sources.list" -o Dir::Etc::SourceParts=/dev/null
  -o "Dir::State::Lists=$scratch/lists" -o APT::Sandbox::User=root)
apt-get -q "${options[@]}" update
apt-get -q "${options[@]}" source ceres-solver
cmake -S ceres-solver-*/ -B build -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF \
  -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DCMAKE_INSTALL_PREFIX="$prefix" -DCMAKE_CXX_VISIBILITY_PRESET=hidden \
  -DMINIGLOG=ON -DGFLAGS=OFF -DSUITESPARSE=OFF -DCXSPARSE=OFF -DLAPACK=OFF -DEIGENSPARSE=OFF -DCUDA=OFF \
  -DSCHUR_SPECIALIZATIONS=OFF -DBUILD_TESTING=OFF -DBUILD_EXAMPLES=OFF -DBUILD_BENCHMARKS=OFF \
  -DPROVIDE_UNINSTALL_TARGET=OFF
cmake --build build --parallel "${2:-$(nproc)}"
cmake --install build
